"""The stubs name what the module has, and the examples can be read."""

import ast
import inspect
import pathlib

import curious
from curious import _native

STUBS = pathlib.Path(curious.__file__).with_name("_native.pyi")


def test_the_stubs_are_those_of_the_module():
    names = {}
    for node in ast.parse(STUBS.read_text()).body:
        if isinstance(node, ast.ClassDef):
            names[node.name] = {
                item.name if isinstance(item, ast.FunctionDef) else item.target.id
                for item in node.body
                if isinstance(item, (ast.FunctionDef, ast.AnnAssign))
            }
        elif isinstance(node, ast.FunctionDef):
            names[node.name] = None
    module = {name for name in dir(_native) if not name.startswith("_")} - {"Readings"}
    assert set(names) - {"Strategy"} == module
    for name in module:
        item = getattr(_native, name)
        assert item.__doc__, f"{name} has no docstring"
        if inspect.isclass(item) and not issubclass(item, Exception):
            members = {member for member in vars(item) if not member.startswith("_")}
            assert members == {member for member in names[name] if not member.startswith("_")}, name
            for member in members - {"autoreset"}:
                assert getattr(item, member).__doc__, f"{name}.{member} has no docstring"


def test_everything_is_exported():
    public = {name for name in dir(_native) if not name.startswith("_")} - {"Readings"}
    assert public | {"__version__"} == set(curious.__all__)

"""What the installed ROS packages define, read from their files without importing them."""

from __future__ import annotations

import ast
import contextlib
import importlib
import importlib.util
import re
import sys
import warnings
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from importlib import metadata
from pathlib import Path
from types import ModuleType

from ros2lab.diagnose.sources.bindings import bound_by
from ros2lab.diagnose.sources.python_source import Function, children, read_text, walk
from ros2lab.diagnose.sources.spelling import nearest, snake_case
from ros2lab.manifest_words import KEYS

# The packages that a student may name, even if they are not installed.
_NAMES = """
    rclpy rclcpp std_msgs std_srvs geometry_msgs sensor_msgs nav_msgs diagnostic_msgs shape_msgs stereo_msgs
    trajectory_msgs visualization_msgs actionlib_msgs action_msgs example_interfaces builtin_interfaces
    rcl_interfaces lifecycle_msgs rosgraph_msgs unique_identifier_msgs composition_interfaces tf2 tf2_ros tf2_msgs
    tf2_geometry_msgs tf2_py tf2_ros_py sensor_msgs_py tf_transformations turtlesim launch launch_ros launch_testing launch_xml launch_yaml
    ament_index_python ament_cmake ament_cmake_python ament_python rosidl_default_generators
    rosidl_default_runtime rosidl_runtime_py ros2launch xacro robot_state_publisher joint_state_publisher rviz2 nav2_msgs
    nav2_simple_commander control_msgs cv_bridge image_transport message_filters ament_copyright ament_flake8
    launch_testing_ros launch_pytest ament_pep257 ament_lint_auto ament_lint_common ament_mypy ament_xmllint demo_nodes_py demo_nodes_cpp
    """
PACKAGES = frozenset(_NAMES.split())
# Where ROS looks for the packages of a prefix: one file for each, with the name of the package.
INDEX = "share/ament_index/resource_index/packages"
# The modules from which launch files import.
LAUNCH_MODULES = (
    "launch_ros.actions",
    "launch.actions",
    "launch.substitutions",
    "launch_ros.substitutions",
    "launch.conditions",
    "launch.launch_description_sources",
    "launch_xml.launch_description_sources",
    "launch_yaml.launch_description_sources",
    "launch",
    "ament_index_python.packages",
)


@lru_cache(maxsize=256)
def folder_of(package: str) -> Path | None:
    """Return the folder of an installed top-level Python package; None if there is none."""
    try:
        spec = importlib.util.find_spec(package) if package.isidentifier() else None
    except (ImportError, ValueError):
        return None
    places = list(spec.submodule_search_locations or []) if spec else []
    return Path(places[0]) if places else None


def package_of(module: str) -> str:
    """Return the package that brings a top-level module, as it is called in a package.xml."""
    return _brought(tuple(sys.path)).get(module) or KEYS.get(module, module)


def install_of(package: str) -> str:
    """Return the command that installs a package of ROS on Ubuntu."""
    return f"sudo apt install ros-jazzy-{package.replace('_', '-')}"


@lru_cache(maxsize=1)
def _brought(path: Sequence[str]) -> Mapping[str, str]:
    """Return the installed packages of ROS by the modules that they bring."""
    lists = [file for folder in path for file in sorted(Path(folder).glob("*.egg-info/top_level.txt"))]
    names = {file: file.parent.name.removesuffix(".egg-info").partition("-")[0] for file in lists}
    own = [file for file in lists if any((up / INDEX / names[file]).is_file() for up in file.parents[4:6])]
    return {module: names[file] for file in own for module in read_text(file).split()}


@lru_cache(maxsize=256)
def meant(package: str) -> str | None:
    """Return the ROS package that a misspelt name means; None if there is none, or if the name is correct."""
    close = None if package in PACKAGES or is_installed(package) else nearest(package, PACKAGES, 0.85)
    return None if close and package.startswith(f"{close}_") else close  # sensor_msgs_py is another package


def is_installed(module: str) -> bool:
    """Return whether a top-level module is installed."""
    try:
        return importlib.util.find_spec(module) is not None
    except (ImportError, ValueError):
        return False


def is_library(module: str) -> bool:
    """Return whether a top-level module was installed as a distribution of Python that is no package of ROS."""
    # To ask which distributions there are, and what each brings, takes as long as a workspace.
    names = metadata.packages_distributions().get(module, ()) if is_installed(module) else ()
    homes = (Path(str(metadata.distribution(name).locate_file(""))) for name in names)
    prefixes = [prefix for home in homes for prefix in home.parents[2:4]]
    return bool(prefixes) and not any((prefix / INDEX / module).is_file() for prefix in prefixes)


def is_module(name: str) -> bool:
    """Return whether a dotted name is a module in an installed package or in Python itself."""
    path = _place_of(name)
    if path is None:
        return False
    files = (path.with_suffix(".py"), path / "__init__.py", *path.parent.glob(f"{path.name}.*.so"))
    return any(file.is_file() for file in files) or _is_in_portable_launch(name)


def _is_in_portable_launch(name: str) -> bool:
    """Return whether the portable launch finds a module for which it has no file, as it does for each of its classes."""
    homes = [
        folder.parent for folder in (folder_of(name.partition(".")[0]), folder_of("portable_ros2")) if folder
    ]
    has_paths = len(homes) == 2 and homes[0] == homes[1] and (homes[0] / "launch" / "paths.py").is_file()
    return has_paths and name.rpartition(".")[2].islower() and is_installed(name)


def _place_of(module: str) -> Path | None:
    """Return the path of an installed module without its ending; None if its package is not installed."""
    package, *rest = module.split(".")
    folder = folder_of(package)
    return folder.joinpath(*rest) if folder else None


def text_of(module: str) -> str:
    """Return the text of an installed module; empty if it is not there, or is a package."""
    return read_text((_place_of(module) or Path("-")).with_suffix(".py"))


def _files_of(module: str) -> list[Path]:
    """Return the files directly in an installed package, or the file of a module, whether it is there or not."""
    path = _place_of(module) or Path("-")
    return sorted(path.glob("*.py")) if path.is_dir() else [path.with_suffix(".py")]


def _defining(name: str, files: Iterable[Path], what: str = "class|def") -> list[Path]:
    """Return the files that define a class or a function of a name."""
    pattern = re.compile(rf"^(?:{what}) {re.escape(name)}\b", re.MULTILINE)
    return [file for file in files if pattern.search(read_text(file))]


@lru_cache(maxsize=256)
def names_in(module: str, *, is_own: bool = False) -> frozenset[str] | None:
    """Return the names that can be imported from a module such as `std_msgs.msg`, perhaps only its package's own; None if not known."""
    path = _place_of(module) or Path("-")
    file = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    if not file.is_file():
        return None
    run = (n for n in _run_on_import(ast.parse(read_text(file))) if not (is_own and _is_of_others(n, module)))
    names = frozenset(name for node in run for name in bound_by(node))
    return None if "__getattr__" in names or "*" in names else names | _inner_modules(path)


def _is_of_others(node: ast.AST, module: str) -> bool:
    """Return whether a module imports something from another package, such as `List` from typing."""
    of = node.module if isinstance(node, ast.ImportFrom) and not node.level else None
    return isinstance(node, ast.Import) or (of or module).partition(".")[0] != module.partition(".")[0]


def _inner_modules(path: Path) -> frozenset[str]:
    """Return the names of the modules and folders of modules directly inside a folder."""
    inner = {file.parent.name for file in path.glob("*/*.py")}
    return frozenset(
        inner.union(file.name.partition(".")[0] for form in ("*.py", "*.so") for file in path.glob(form))
    )


# Importing these packages, or any __main__, runs a program.
PROGRAMS = frozenset(("antigravity", "idlelib", "test", "this"))


def own_module(name: str) -> ModuleType | None:
    """Return a module of the standard library; None for any other module, a program, and one of other systems."""
    first, *inner = name.split(".")
    is_harmless = first in sys.stdlib_module_names - PROGRAMS and "__main__" not in inner
    with warnings.catch_warnings(), contextlib.suppress(ImportError):
        warnings.simplefilter("ignore")  # that a module is old is no news about the code that is looked at
        return importlib.import_module(name) if is_harmless else None
    return None


def has_name(module: str, name: str) -> bool:
    """Return whether a module, installed or of the standard library, has a name that is no module itself."""
    return name in (importable_names(module) or ()) and not is_module(f"{module}.{name}")


def importable_names(module: str) -> frozenset[str] | None:
    """Return the names that can be imported from an installed module or one of Python's own; None if not known."""
    if module.partition(".")[0] not in sys.stdlib_module_names:
        return names_in(module) or _names_looked_up(module)
    own = own_module(module)
    return frozenset(dir(own)) | _submodules(module) if own else None


@lru_cache(maxsize=64)
def _names_looked_up(module: str) -> frozenset[str] | None:
    """Return the names that a package with a `__getattr__` may know: those that its files mention; else None."""
    path = _place_of(module) or Path("-")
    text = read_text(path / "__init__.py")
    if "__getattr__" not in text:
        return None
    texts = map(read_text, path.glob("*.py"))
    defined = (re.findall(r"^(?:class|def) (\w+)", inner, re.MULTILINE) for inner in texts)
    return frozenset(re.findall(r"[A-Za-z_]\w*", text)).union(*defined) | _submodules(module)


def module_meant(name: str) -> str:
    """Return the module that a misspelled dotted name means, or the name itself; empty if there is none."""
    first, *rest = name.split(".")
    of_python = [module for module in sys.stdlib_module_names if not module.startswith("_")]
    found = first if is_installed(first) else meant(first) or nearest(first, of_python, 0.85) or ""
    for part in rest if found else ():
        inner = _submodules(found)
        close = part if part in inner else nearest(part, inner, 0.6)
        if not close:
            return ""
        found = f"{found}.{close}"
    return found


def homes_around(name: str, module: str, imported: Collection[str] = ()) -> list[str]:
    """Return the modules that define a name: those around a module first, then those of Python.

    Of Python's modules, one counts only if no other defines the name, or if its own begins with the name; and where a
    module is given, only if it is `imported`, or if the module exists and the name is that of a class.
    """
    package = module.partition(".")[0]
    near = [package, *(f"{package}.{inner}" for inner in sorted(_submodules(package)))]
    found = [home for home in near if home != module and has_name(home, name)]
    of_python = [home for home in _defined_by_python().get(name, ()) if home != module]
    is_class = not module or (name[:1].isupper() and importable_names(module) is not None)
    of_python = [home for home in of_python if is_class or home in imported]
    first = [home for home in of_python if home.startswith(name.lower())]
    return found + (first or of_python if len(first or of_python) == 1 else [])


@lru_cache(maxsize=1)
def _defined_by_python() -> Mapping[str, tuple[str, ...]]:
    """Return the public modules of Python that define each class and function."""
    found: dict[str, list[str]] = {}
    folder = Path(ast.__file__).parent
    for module in sorted(sys.stdlib_module_names - PROGRAMS):
        path = folder / f"{module}.py"
        if not module.startswith("_") and path.is_file():
            for name in re.findall(r"^(?:class|def) ([A-Za-z]\w*)", read_text(path), re.MULTILINE):
                found.setdefault(name, []).append(module)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # some of these modules will go, and say so
        for module in sys.builtin_module_names:
            if not module.startswith("_"):
                for name in vars(importlib.import_module(module)):
                    found.setdefault(name, []).append(module)
    return {name: tuple(dict.fromkeys(modules)) for name, modules in found.items()}


@lru_cache(maxsize=256)
def _submodules(package: str) -> frozenset[str]:
    """Return the names of the public modules directly inside an installed package."""
    inner = _inner_modules(_place_of(package) or Path("-"))
    return frozenset(name for name in inner if not name.startswith("_"))


def nearest_module(name: str) -> str | None:
    """Return the installed module that a misspelt name such as `rclpy.nod` means; None if there is none."""
    parent, _, last = name.rpartition(".")
    close = nearest(last, names_in(parent) or (), 0.6) if parent else meant(name)
    return f"{parent}.{close}" if parent and close else close


def _run_on_import(parent: ast.AST) -> Iterator[ast.AST]:
    """Yield what runs when a module is imported, without what is only for type checkers."""
    for node in children(parent):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            continue
        yield node
        if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)):
            yield from _run_on_import(node)


@lru_cache(maxsize=512)
def fields_of(type_name: str | None) -> Mapping[str, str] | None:
    """Return the fields of a message such as `geometry_msgs.msg.Twist`, name to type; None if not known.

    A part of a service or an action has the name of its class: `std_srvs.srv.SetBool_Request`.
    """
    package, _, rest = (type_name or "").partition(".")
    kind, _, name = rest.partition(".")
    folder = folder_of(package)
    if folder is None or kind not in ("msg", "srv", "action") or not name.isidentifier():
        return None
    snake = snake_case(name.partition("_")[0])
    text = read_text(folder / kind / f"_{snake}.py")
    match = re.search(
        rf"^class {name}\(.*?_fields_and_field_types = (\{{.*?\}})", text, re.DOTALL | re.MULTILINE
    )
    fields = ast.literal_eval(match[1]) if match else None
    return fields if isinstance(fields, dict) else None


def field_kind(field: str | None) -> str | None:
    """Return the kind of a message field from its type, such as `double` or `geometry_msgs/Vector3`."""
    if field is None or "[" in field or "<" in field:
        return None
    if "/" in field:
        return field.replace("/", ".msg.")
    named = {"float": "float", "double": "float", "string": "str", "wstring": "str", "boolean": "bool"}
    return named.get(field, "int" if "int" in field else None)


def is_interface(type_name: str | None) -> bool:
    """Return whether a dotted name has the form of a message, a service or an action."""
    return bool(type_name and re.fullmatch(r"\w+\.(msg|srv|action)\.\w+", type_name))


@lru_cache(maxsize=64)
def homes_of(name: str) -> tuple[str, ...]:
    """Return the modules from which a message, a service or a class of rclpy is imported."""
    interfaces = sorted(
        package for package in PACKAGES if package.endswith(("_msgs", "_srvs", "_interfaces"))
    )
    modules = [f"{package}.{kind}" for package in interfaces for kind in ("msg", "srv")]
    modules = [module for module in modules if name in (names_in(module) or ())]
    folder = folder_of("rclpy")
    own = _defining(name, sorted(folder.glob("*.py")), "class") if folder else ()
    modules += [f"rclpy.{file.stem}" for file in own]
    # Common packages come first.
    return tuple(
        sorted(modules, key=lambda module: (not module.startswith(("std_", "geometry_", "rclpy")), module))
    )


@lru_cache(maxsize=256)
def launch_homes_of(name: str) -> Sequence[str]:
    """Return the modules from which launch files import a class or a function."""
    pattern = re.compile(rf"^(?:(?:class|def) {name}\b|{name} = )", re.MULTILINE)
    return tuple(
        module
        for module in LAUNCH_MODULES
        if any(pattern.search(read_text(file)) for file in _files_of(module))
    )


def homes_for(name: str, imported: Iterable[str]) -> Sequence[str]:
    """Return the modules from which a file should import a class or a function.

    A file that imports launch gets the modules of launch, if there are any.
    """
    of_launch, of_ros = launch_homes_of(name), homes_of(name)
    is_launch = any(module.startswith("launch") for module in imported)
    return (of_launch or of_ros) if is_launch else (of_ros or of_launch)


def only_field(class_name: str) -> str:
    """Return `data` if that is the only field of a message; empty for any other class."""
    fields = [fields_of(f"{home}.{class_name}") or {} for home in homes_of(class_name)]
    return "data" if any(list(mapping) == ["data"] for mapping in fields) else ""


_MOST_METHODS = 12


def methods_of(class_name: str) -> str:
    """Return the public methods and properties of an installed class, joined by commas; empty if none."""
    found = next((class_in(home, class_name) for home in homes_of(class_name)), None)
    defined = [node.name for node in found.body if isinstance(node, ast.FunctionDef)] if found else []
    return ", ".join([*dict.fromkeys(name for name in defined if not name.startswith("_"))][:_MOST_METHODS])


@lru_cache(maxsize=32)
def inner_homes_of(name: str) -> tuple[str, ...]:
    """Return the modules of rclpy that define a class or a function, inner modules included."""
    folder = folder_of("rclpy")
    found = _defining(name, sorted(folder.rglob("*.py"))) if folder else ()
    return tuple(".".join(path.relative_to(folder.parent).with_suffix("").parts) for path in found if folder)


@lru_cache(maxsize=32)
def class_in(module: str, class_name: str) -> ast.ClassDef | None:
    """Return the definition of a class in an installed module or package; None if there is none."""
    texts = (text for text in map(read_text, _files_of(module)) if f"class {class_name}" in text)
    classes = (node for text in texts for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ClassDef))
    return next((node for node in classes if node.name == class_name), None)


def method_of(module: str, class_name: str, name: str) -> ast.FunctionDef | None:
    """Return the definition of a method of an installed class; None if it is missing or decorated."""
    found = class_in(module, class_name)
    defined = [node for node in (found.body if found else ()) if isinstance(node, ast.FunctionDef)]
    return next((method for method in defined if method.name == name and not method.decorator_list), None)


def node_members() -> frozenset[str]:
    """Return the members of rclpy's Node."""
    return members_of("rclpy.node", "Node")


@lru_cache(maxsize=16)
def members_of(module: str, class_name: str) -> frozenset[str]:
    """Return the members of an installed class."""
    found = class_in(module, class_name)
    nodes = [*walk(found)] if found else []
    members = {node.name for node in nodes if isinstance(node, Function)}
    members |= {n.attr for n in nodes if isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Store)}
    for statement in found.body if found else ():
        targets = getattr(statement, "targets", [getattr(statement, "target", None)])
        members |= {target.id for target in targets if isinstance(target, ast.Name)}
    return frozenset(members)


@lru_cache(maxsize=1)
def node_properties() -> frozenset[str]:
    """Return the properties of rclpy's Node, and the attributes that it assigns to itself."""
    return frozenset(name for name in node_members() if method_of("rclpy.node", "Node", name) is None)


@lru_cache(maxsize=1)
def fixed_node_properties() -> frozenset[str]:
    """Return the properties of rclpy's Node that cannot be set."""
    found = class_in("rclpy.node", "Node")
    fixed: set[str] = set()
    settable: set[str] = set()
    for method in (node for node in (walk(found) if found else ()) if isinstance(node, Function)):
        decorators = {ast.unparse(decorator) for decorator in method.decorator_list}
        fixed |= {method.name} if "property" in decorators else set()
        if f"{method.name}.setter" in decorators and not isinstance(method.body[-1], ast.Raise):
            settable.add(method.name)  # one that only raises sets nothing
    return frozenset(fixed - settable)

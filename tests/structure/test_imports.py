"""The direction of imports: a file imports from its own room or a lower one, never in a circle, never hidden."""

import ast
from pathlib import Path

import lenstrace

PACKAGE = Path(lenstrace.__file__).parent
# Lowest first. `compute` knows no optics, `errors` nothing at all.
ROOMS = [
    "errors",
    "compute",
    "accuracy",
    "optics",
    "sequential",
    "analysis",
    "design",
    "scene",
    "phenomena",
    "io",
    "plotting",
    "cli",
    "__init__",
    "__main__",
]
FILES = sorted(PACKAGE.rglob("*.py"))


def module_of(path: Path) -> str:
    """lenstrace/optics/rays.py -> lenstrace.optics.rays"""
    parts = ("lenstrace", *path.relative_to(PACKAGE).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 2 else parts)


MODULES = {module_of(path) for path in FILES}
TREES = {path: ast.parse(path.read_text()) for path in FILES}


def room_of(module: str) -> str:
    """The second part of a module's name; the package itself is its __init__."""
    parts = module.split(".")
    return parts[1] if len(parts) > 1 else "__init__"


def own_imports(tree: ast.AST) -> list[tuple[ast.stmt, str]]:
    """Every import statement of this package, with the module it names."""
    found: list[tuple[ast.stmt, str]] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "lenstrace":
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                found.append((node, inner if inner in MODULES else node.module or ""))
        elif isinstance(node, ast.Import):
            found += [(node, alias.name) for alias in node.names if alias.name.split(".")[0] == "lenstrace"]
    return found


def for_types_only(tree: ast.AST) -> set[ast.stmt]:
    """Statements under `if TYPE_CHECKING:`, which never run."""
    guards = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
    ]
    return {statement for guard in guards for part in guard.body for statement in ast.walk(part)}  # type: ignore[misc]


def test_no_import_runs_upward() -> None:
    for path, tree in TREES.items():
        here = ROOMS.index(room_of(module_of(path)))
        skipped = for_types_only(tree)
        for node, module in own_imports(tree):
            if node not in skipped:
                there = ROOMS.index(room_of(module))
                assert there <= here, f"{path.name} imports {module}, which stands above it"


def test_no_own_import_is_hidden_in_a_function() -> None:
    for path, tree in TREES.items():
        for function in ast.walk(tree):
            if isinstance(function, (ast.FunctionDef, ast.AsyncFunctionDef)):
                hidden = [module for _, module in own_imports(function)]
                assert not hidden, f"{path.name}, {function.name} hides an import of {hidden}"


def test_no_circles() -> None:
    graph = {}
    for path, tree in TREES.items():
        skipped = for_types_only(tree)
        graph[module_of(path)] = {module for node, module in own_imports(tree) if node not in skipped}
    finished: set[str] = set()

    def visit(module: str, above: tuple[str, ...]) -> None:
        assert module not in above, f"imports run in a circle: {' -> '.join((*above, module))}"
        if module not in finished:
            for other in graph.get(module, ()):
                visit(other, (*above, module))
            finished.add(module)

    for module in graph:
        visit(module, ())


def test_every_file_says_its_idea_first() -> None:
    for path, tree in TREES.items():
        docstring = ast.get_docstring(tree)
        assert docstring, f"{path} has no docstring"
        first = docstring.split("\n\n")[0].split("\n    ")[0].strip()
        assert first.endswith((".", ":", ",")), f"{path}: the first sentence of the docstring has no end"


def test_public_functions_and_classes_have_docstrings() -> None:
    for path, tree in TREES.items():
        classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
        for node in [*tree.body, *(inner for each in classes for inner in each.body)]:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_"):
                assert ast.get_docstring(node), f"{path.name}: {node.name} has no docstring"


def test_public_names_exist() -> None:
    assert set(lenstrace.__all__) <= set(dir(lenstrace))
    for name in lenstrace.__all__:
        assert getattr(lenstrace, name) is not None


def test_heavy_packages_wait_until_they_are_used() -> None:
    import subprocess
    import sys

    heavy = ("matplotlib", "pydantic", "scipy.stats", "rich", "mpmath")
    script = f"import sys, lenstrace; print([name for name in {heavy} if name in sys.modules])"
    printed = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert printed.strip() == "[]"

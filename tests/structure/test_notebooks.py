"""The notebooks: without outputs as committed, built on public names, and run from top to bottom without an error."""

import ast
from pathlib import Path

import nbformat
import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))
TIMEOUT_S = 300
# Beside the standard library's.
ALLOWED_IMPORTS = {
    "dataclasses",
    "importlib.util",
    "ipywidgets",
    "jax",
    "jax.numpy",
    "lenstrace",
    "lenstrace.accuracy.trade",
    "lenstrace.design",
    "lenstrace.scene",
    "matplotlib.pyplot",
    "numpy",
    "pathlib",
    "tempfile",
}

every_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def test_there_are_notebooks() -> None:
    named = {
        "a_first_lens",
        "principal_planes_and_newton",
        "reading_the_aberrations_of_a_lens",
        "what_does_accuracy_cost",
        "what_a_lens_is",
        "negative_index",
        "bending_at_a_surface",
        "one_law_for_thin_things",
        "straight_lines",
        "bending_a_singlet",
        "a_cooke_triplet_from_three_flat_plates",
        "what_limits_this_lens",
        "from_appel_to_path_tracing",
        "noise_and_its_price",
        "a_photograph_through_the_double_gauss",
    }
    assert named <= {path.stem for path in NOTEBOOKS}


@every_notebook
def test_committed_without_outputs(path: Path) -> None:
    notebook = nbformat.read(path, as_version=nbformat.NO_CONVERT)
    nbformat.validate(notebook)
    assert (notebook.nbformat, notebook.nbformat_minor) == (4, 5)
    assert set(notebook.metadata) <= {"kernelspec", "language_info"}
    for cell in notebook.cells:
        assert not cell.metadata, f"{cell.id}: metadata"
        if cell.cell_type == "code":
            assert not cell.outputs, f"{cell.id}: clear the outputs before committing"
            assert cell.execution_count is None, f"{cell.id}: clear the outputs before committing"


@every_notebook
def test_only_public_names(path: Path) -> None:
    for cell in nbformat.read(path, as_version=4).cells:
        if cell.cell_type == "code":
            for node in ast.walk(ast.parse(cell.source)):
                if isinstance(node, ast.Import):
                    assert {alias.name for alias in node.names} <= ALLOWED_IMPORTS, cell.id
                elif isinstance(node, ast.ImportFrom):
                    assert node.module in ALLOWED_IMPORTS, cell.id


@every_notebook
def test_runs_without_an_error(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By this very interpreter, whatever kernels and settings of Jupyter are installed."""
    for variable in ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR"):
        monkeypatch.setenv(variable, str(tmp_path))
    # Without it jupyter_core 5 warns, when it is imported, that its folders will move.
    monkeypatch.setenv("JUPYTER_PLATFORM_DIRS", "1")
    from jupyter_client.kernelspec import KernelSpecManager
    from jupyter_client.manager import AsyncKernelManager
    from nbclient import NotebookClient

    # No folder to look in: what is left is the kernel that ipykernel offers for sys.executable.
    kernels = KernelSpecManager(kernel_dirs=[])
    notebook = nbformat.read(path, as_version=4)
    client = NotebookClient(
        notebook,
        timeout=TIMEOUT_S,
        km=AsyncKernelManager(kernel_name="python3", kernel_spec_manager=kernels),
        resources={"metadata": {"path": str(path.parent)}},
    )
    # nbclient closes the channels of a kernel manager that it was given only when told to.
    client.execute(cleanup_kc=True)
    warnings = [
        output.text
        for cell in notebook.cells
        for output in cell.get("outputs", ())
        if output.output_type == "stream" and output.name == "stderr" and "Warning:" in output.text
    ]
    assert not warnings

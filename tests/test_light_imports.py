"""Reading data and asking for help load neither the kernels nor the simulator, and work where these cannot."""

import subprocess
import sys

import pytest

WITHOUT = "import sys; sys.modules['numba'] = sys.modules['pybullet'] = None; "


def run(code: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", WITHOUT + code], capture_output=True, text=True)


@pytest.mark.slow
@pytest.mark.parametrize("module", ["remqa_data.cli", "remqa_data.generators.cli", "remqa_data.evaluation.cli"])
@pytest.mark.parametrize("option", ["--help"])
def test_every_command_helps_without_kernels(module: str, option: str) -> None:
    done = run(f"sys.argv = ['command', '{option}']; import {module}; {module}.main()")
    assert done.returncode == 0, done.stderr
    assert "Usage: command" in done.stdout


@pytest.mark.slow
def test_datasets_and_vocabularies_are_read_without_kernels(tmp_path) -> None:
    from tests.helpers.dataset_rows import write_dataset

    write_dataset(tmp_path)
    done = run(
        "from remqa_data import ExpressionDataset, FrameDataset, RemqaDataset, Vocabulary, collate\n"
        f"root = {str(tmp_path)!r}\n"
        "[dataset(root, 'train')[0] for dataset in (RemqaDataset, FrameDataset, ExpressionDataset)]\n"
        "print(len(Vocabulary.from_dataset(root).words) > 2)"
    )
    assert done.stdout == "True\n", done.stderr


@pytest.mark.slow
def test_curves_are_drawn_without_pytorch(tmp_path) -> None:
    code = f"sys.modules['torch'] = None; sys.argv = ['command', 'curves', '--weights', {str(tmp_path)!r}]"
    done = run(f"{code}; import remqa_data.agents.cli as cli; cli.main()")
    assert done.returncode == 2, done.stderr
    assert "has no curves of any network" in done.stderr


@pytest.mark.slow
def test_features_that_need_pytorch_name_the_extra() -> None:
    code = "import sys; sys.modules['torch'] = None; from remqa_data.views.features import load_function; "
    code += "load_function('remqa_data.agents.view_features:features')"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "MissingExtraError: torch is not installed; run: pip install 'remqa-data[agents]'" in done.stderr

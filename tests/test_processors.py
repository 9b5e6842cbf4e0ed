"""Another processor, another library kernel or another sine: the same bytes.

One machine stands for many, because the libraries can be told to do without what its processor has.
"""

import ast
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[1]
CPUINFO = Path("/proc/cpuinfo")
FLAGS = set(CPUINFO.read_text(encoding="utf-8").split()) if CPUINFO.exists() else set()
NO_FUSED_SINES = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2"}
OLD_NUMPY = {"NPY_DISABLE_CPU_FEATURES": "X86_V3"}
OLD_OPENCV = {"OPENCV_CPU_DISABLE": "AVX2,FP16,AVX,SSE4_2", "OPENCV_IPP": "disabled"}
OLD_MACHINE = {
    "OPENBLAS_CORETYPE": "Prescott",
    "NUMBA_CPU_NAME": "generic",
    "NUMBA_CPU_FEATURES": "",
    **NO_FUSED_SINES,
    **OLD_NUMPY,
    **OLD_OPENCV,
}
"""A processor of 2004, as far as the libraries can tell."""

NONE = {"EXISTENCE": 0, "COUNTING": 0, "SPATIAL": 0}

DRAWN_THEN_SNAPPED = (
    *(f"remqa_data/assets/{folder}/" for folder in ("mesh", "parts", "types", "looks")),
    *(f"remqa_data/assets/core/{module}.py" for module in ("builder", "posed", "shapes")),
)
"""What only draws: `assets.core.fitting` snaps its meshes, and textures are whole numbers."""
FOR_PEOPLE = ("generators/figures/", "remqa_data/thor/", "remqa_data/env/", "remqa_data/sim/agent/third_person.py")
"""Pictures to look at, and AI2-THOR's figures; nothing of a dataset."""
SINES = (
    "sin",
    "cos",
    "tan",
    "arcsin",
    "arccos",
    "arctan",
    "arctan2",
    "asin",
    "acos",
    "atan",
    "atan2",
    "exp",
    "log",
    "pow",
)
OF_NUMPY = ("power", "hypot", "cbrt", "tanh", "linalg", "einsum", "dot", "vdot", "inner", "matmul", "tensordot")
BY_THE_PROCESSOR = {f"{module}.{name}" for module in ("np", "math") for name in SINES} | {
    f"np.{name}" for name in OF_NUMPY
}
"""Functions whose last digit depends on the processor; math.hypot and math.dist are Python's own, and do not."""


def run(command: list[str], environment: dict[str, str], kernels: Path) -> str:
    """What a Python process prints on a machine with some environment.

    Kernels for another processor are kept in a folder of their own, by Numba under that processor's name; those for this
    one are where they always are.
    """
    variables = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    if "NUMBA_CPU_NAME" in environment:
        variables["NUMBA_CACHE_DIR"] = str(kernels)
    done = subprocess.run([sys.executable, *command], env=variables, capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return done.stdout


def fingerprints(wanted: str, environment: dict[str, str], kernels: Path) -> list[str]:
    """The lines of `tests.helpers.fingerprints`."""
    return run(["-m", "tests.helpers.fingerprints", *wanted.split()], environment, kernels).splitlines()


@pytest.fixture(scope="module")
def kernels(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where kernels for other processors are kept: each is compiled once for all tests."""
    return tmp_path_factory.mktemp("kernels")


@pytest.fixture(scope="module")
def here(kernels: Path) -> list[str]:
    return fingerprints("meshes rooms", {}, kernels)


@pytest.mark.skipif("fma" not in FLAGS, reason="nothing can be taken away from this processor")
def test_an_old_machine_computes_other_last_digits(kernels: Path) -> None:
    """Else the other tests here would show nothing; less than one sine in a thousand is another one."""
    command = ["-c", "import math; print(hash(tuple(math.sin(k / 7000) for k in range(100_000))))"]
    assert run(command, {}, kernels) != run(command, OLD_MACHINE, kernels)


@pytest.mark.slow
@pytest.mark.parametrize(
    "environment",
    [pytest.param(OLD_MACHINE, id="old"), pytest.param({"OPENBLAS_CORETYPE": "Zen"}, id="zen")],
)
def test_meshes_and_rooms_are_the_same_on_another_machine(
    here: list[str], environment: dict[str, str], kernels: Path
) -> None:
    assert fingerprints("meshes rooms", environment, kernels) == here


@pytest.mark.slow
def test_meshes_and_rooms_are_the_same_with_sines_that_are_wrong_in_the_last_digit(
    here: list[str], kernels: Path
) -> None:
    assert fingerprints("--shaken meshes rooms", {}, kernels) == here


@pytest.mark.slow
def test_textures_and_frames_are_the_same_on_another_machine(kernels: Path) -> None:
    machines = ({}, OLD_MACHINE, {"NUMBA_CPU_NAME": "haswell"})
    drawn = [fingerprints("textures frames", environment, kernels) for environment in machines]
    assert drawn[0] == drawn[1] == drawn[2]


@pytest.mark.slow
def test_a_dataset_is_the_same_on_another_machine(kernels: Path, tmp_path: Path) -> None:
    config = yaml.safe_load((ROOT / "configs" / "tiny.yaml").read_text(encoding="utf-8"))
    config |= {"scenes": ["FloorPlan27"], "questions": {**config["questions"], "train": NONE}, "configurations": 4}
    (tmp_path / "room.yaml").write_text(yaml.safe_dump(config), encoding="utf-8")
    made = []
    for i, environment in enumerate(({}, OLD_MACHINE)):
        out = tmp_path / f"out {i}"
        code = ["-c", "from remqa_data.generators.cli import main; main()"]
        options = ["--config", str(tmp_path / "room.yaml"), "--workers", "1", "--out", str(out)]
        run([*code, *options], environment, kernels)
        made.append({path.relative_to(out): path.read_bytes() for path in out.rglob("*") if path.is_file()})
    assert len(made[0]) > 5
    assert made[0] == made[1]


def modules() -> Iterator[Path]:
    """What makes stored bytes."""
    for folder in ("remqa_data", "generators"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            name = path.relative_to(ROOT).as_posix()
            if not name.startswith(DRAWN_THEN_SNAPPED + FOR_PEOPLE) and name != "remqa_data/geometry/arithmetic.py":
                yield path


def test_what_is_stored_is_computed_with_arithmetic_of_a_fixed_order() -> None:
    found = []
    for path in modules():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            is_product = isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.MatMult)
            if is_product or (isinstance(node, ast.Attribute) and ast.unparse(node) in BY_THE_PROCESSOR):
                found.append(f"{path.relative_to(ROOT)}:{node.lineno}: {ast.unparse(node)}")
    assert not found, "use remqa_data.geometry.arithmetic:\n" + "\n".join(found)


def test_kernels_are_compiled_with_every_rounding_as_written() -> None:
    assert (ROOT / "remqa_data" / "compiled.py").is_file()
    for path in sorted((ROOT / "remqa_data").rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        assert "fastmath" not in {node.arg for node in ast.walk(tree) if isinstance(node, ast.keyword)}, path
        imports = {alias.name for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) for alias in node.names}
        assert path.name == "compiled.py" or not imports & {"njit", "jit", "vectorize", "guvectorize"}, path

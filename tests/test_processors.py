"""Another processor, another library kernel or another sine: the same bytes.

One machine stands for many, because the libraries can be told to do without what its processor has.
"""

import ast
import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from remqa_data import compiled
from tests.helpers.damaged_files import files_of
from tests.helpers.real_datasets import made_once

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

WIDE_MACHINE = {"OPENBLAS_CORETYPE": "SkylakeX"}
"""One with AVX-512, whose small products OpenBLAS sums up in another order; what it takes by itself where it finds one."""
NEWER_MACHINE = {"OPENBLAS_CORETYPE": "Zen", "NUMBA_CPU_NAME": "haswell"}
EVERYTHING = "textures meshes rooms frames"

DRAWN_THEN_SNAPPED = (
    *(f"remqa_data/assets/{folder}/" for folder in ("mesh", "parts", "types", "looks")),
    *(f"remqa_data/assets/core/{module}.py" for module in ("builder", "posed", "shapes")),
)
"""What only draws: `assets.core.fitting` snaps its meshes, and textures are whole numbers."""
FOR_OTHERS = (
    "generators/figures/",
    "remqa_data/thor/",
    "remqa_data/env/",
    "remqa_data/export/",
    "remqa_data/sim/agent/third_person.py",
)
"""Pictures to look at, AI2-THOR's figures, and files for other simulators; nothing of a dataset."""
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


@dataclass(frozen=True)
class Caches:
    """Where kernels for other processors are kept, and light that they have baked."""

    kernels: Path
    light: Path


def run(command: list[str], environment: dict[str, str], caches: Caches) -> str:
    """What a Python process prints on a machine with some environment.

    Kernels for another processor are kept in a folder of their own, by Numba under that processor's name; those for this
    one are where they always are.
    """
    variables = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    # Light that this machine has baked is not another one's.
    variables["REMQA_CACHE"] = str(caches.light / hashlib.sha256(repr(environment).encode()).hexdigest()[:8])
    if "NUMBA_CPU_NAME" in environment:
        variables["NUMBA_CACHE_DIR"] = str(caches.kernels)
    done = subprocess.run([sys.executable, *command], env=variables, capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return done.stdout


def fingerprints(wanted: str, environment: dict[str, str], caches: Caches) -> list[str]:
    """The lines of `tests.helpers.fingerprints`."""
    return run(["-m", "tests.helpers.fingerprints", *wanted.split()], environment, caches).splitlines()


@pytest.fixture(scope="session")
def caches(pytestconfig: pytest.Config, tmp_path_factory: pytest.TempPathFactory) -> Caches:
    """Kernels are kept from one run of pytest to the next, as those for this processor are: until their sources change."""
    light = made_once(tmp_path_factory, "light", lambda folder: folder.mkdir())
    if not hasattr(pytestconfig, "cache"):  # pytest -p no:cacheprovider
        return Caches(made_once(tmp_path_factory, "kernels", lambda folder: folder.mkdir()), light)
    kernels = pytestconfig.cache.mkdir("kernels")
    for old in kernels.iterdir():
        if old.name != Path(compiled._cache_folder(str(kernels))).name:
            shutil.rmtree(old, ignore_errors=True)
    return Caches(kernels, light)


@pytest.fixture(scope="session")
def here(caches: Caches, tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """All lines of `tests.helpers.fingerprints` on this machine as it is."""

    def write(folder: Path) -> None:
        folder.mkdir()
        (folder / "lines.txt").write_text("\n".join(fingerprints(EVERYTHING, {}, caches)), encoding="utf-8")

    return (made_once(tmp_path_factory, "fingerprints", write) / "lines.txt").read_text(encoding="utf-8").splitlines()


@pytest.mark.skipif("fma" not in FLAGS, reason="nothing can be taken away from this processor")
def test_an_old_machine_computes_other_last_digits(caches: Caches) -> None:
    """Else the other tests here would show nothing; less than one sine in a thousand is another one."""
    command = ["-c", "import math; print(hash(tuple(math.sin(k / 7000) for k in range(100_000))))"]
    assert run(command, {}, caches) != run(command, OLD_MACHINE, caches)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wanted", "environment"),
    [
        pytest.param(EVERYTHING, OLD_MACHINE, id="old"),
        pytest.param("textures frames", NEWER_MACHINE, id="newer"),
        pytest.param(
            "meshes rooms",
            WIDE_MACHINE,
            id="with AVX-512",
            marks=pytest.mark.skipif("avx512f" not in FLAGS, reason="this processor has no AVX-512"),
        ),
        pytest.param("--shaken meshes rooms", NEWER_MACHINE, id="newer, with sines that are wrong in the last digit"),
    ],
)
def test_what_is_drawn_is_the_same_on_another_machine(
    here: list[str], wanted: str, environment: dict[str, str], caches: Caches
) -> None:
    expected = [line for line in here if line.split("\t")[0] in wanted.split()]
    assert expected
    assert fingerprints(wanted, environment, caches) == expected


@pytest.mark.slow
def test_a_dataset_is_the_same_on_another_machine(one_room: Path, caches: Caches, tmp_path: Path) -> None:
    code = (
        "import sys; from remqa_data.generators.pipeline import generate\n"
        "from tests.helpers.real_datasets import one_room_config\n"
        "generate(sys.argv[1], one_room_config())"
    )
    run(["-c", code, str(tmp_path / "out")], OLD_MACHINE, caches)
    assert len(files_of(one_room)) > 5
    assert files_of(tmp_path / "out") == files_of(one_room)


def modules() -> Iterator[Path]:
    """What makes stored bytes."""
    for folder in ("remqa_data", "generators"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            name = path.relative_to(ROOT).as_posix()
            if not name.startswith(DRAWN_THEN_SNAPPED + FOR_OTHERS) and name != "remqa_data/geometry/arithmetic.py":
                yield path


@pytest.mark.slow
def test_what_is_stored_is_computed_with_arithmetic_of_a_fixed_order() -> None:
    paths, found = list(modules()), []
    assert paths
    for path in paths:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            is_product = isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.MatMult)
            if is_product or (isinstance(node, ast.Attribute) and ast.unparse(node) in BY_THE_PROCESSOR):
                found.append(f"{path.relative_to(ROOT)}:{node.lineno}: {ast.unparse(node)}")
    assert not found, "use remqa_data.geometry.arithmetic:\n" + "\n".join(found)


@pytest.mark.slow
def test_kernels_are_compiled_with_every_rounding_as_written() -> None:
    assert (ROOT / "remqa_data" / "compiled.py").is_file()
    for path in sorted((ROOT / "remqa_data").rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        assert "fastmath" not in {node.arg for node in ast.walk(tree) if isinstance(node, ast.keyword)}, path
        imports = {alias.name for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) for alias in node.names}
        assert path.name == "compiled.py" or not imports & {"njit", "jit", "vectorize", "guvectorize"}, path

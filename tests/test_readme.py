import re
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def test_the_code_in_the_readme_runs(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    blocks = re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL)
    assert len(blocks) >= 2
    for block in blocks:
        exec(block, names)
    assert (tmp_path / "kitchen.json").stat().st_size > 10_000
    assert names["seen"].rgb.shape == (300, 300, 3)
    fridge = names["world"].ids.index(names["fridge"])
    assert (names["seen"].objects == fridge).mean() > 0.2

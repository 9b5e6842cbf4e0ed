"""Configurations that cannot be used: each is one line that names the file, and takes no time."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from remqa_data.errors import ConfigError
from remqa_data.generators.config import Config, load_config
from remqa_data.yaml_files import parsed

TINY = (Path(__file__).parents[2] / "configs" / "tiny.yaml").read_text(encoding="utf-8")


def merge_bomb(width: int = 10, depth: int = 8) -> str:
    """Merge keys that double themselves: safe_load took two minutes."""
    lines = ["a0: &a0 {seed: 0}"]
    lines += [f"a{i}: &a{i} {{<<: [{', '.join([f'*a{i - 1}'] * width)}]}}" for i in range(1, depth)]
    return "\n".join(lines) + "\n"


def alias_bomb(width: int = 9, depth: int = 9) -> str:
    lines = ['a0: &a0 ["x"]']
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * width)}]" for i in range(1, depth)]
    return "\n".join(lines) + "\n"


TEXTS = {
    "nothing": "",
    "a comment": "# nothing",
    "a list": "- 1\n- 2",
    "a word": "seed",
    "a number": "17",
    "null": "null",
    "a tab": "seed:\t0\n\tscenes: 4",
    "a brace": "{",
    "two documents": "seed: 0\n---\nseed: 1",
    "a colon too many": "seed: 0: 1",
    "a quote that does not end": 'seed: "0',
    "a control character": "seed: \x07",
    "a zero byte": "seed: \x00",
    "a clock": "seed: 25:61:61",
    "a date that is none": "seed: 2020-99-99",
    "a time that is none": "seed: 2020-01-01 99:99:99",
    "a number of 5,000 digits": "seed: " + "9" * 5000,
    "a Python object": "seed: !!python/object/apply:os.system ['true']",
    "a Python name": "seed: !!python/name:os.system",
    "an unknown tag": "seed: !nobody 1",
    "binary that is none": "seed: !!binary '???'",
    "a set": "!!set {seed, scenes}",
    "a key that is a list": "? [1, 2]\n: 3",
    "a key that is a mapping": "? {a: 1}\n: 3",
    "a key that is a number": "1: 2\n" + TINY,
    "a key that is null": "null: 2\n" + TINY,
    "deep lists": "[" * 100_000,
    "deep lists that end": "[" * 3000 + "]" * 3000,
    "deep mappings": "{a: " * 3000 + "1" + "}" * 3000,
    "deep indents": "\n".join(" " * i + "a:" for i in range(400)),
    "a merge bomb": merge_bomb() + TINY,
    "an alias bomb": alias_bomb() + TINY,
    "a list in itself": "seed: &a [*a]",
    "an alias of nothing": "seed: *nobody",
    "a harmless alias": TINY.replace("seed: 0", "seed: &zero 0"),
    "a megabyte": TINY + "# " + "x" * 1_000_000,
    "a long key": "x" * 100_000 + ": 1",
    "a key in two lines": '? "a\\nb"\n: 1\n' + TINY,
}

VALUES = {
    "seed": ["-1", "9223372036854775808", "1e3", ".inf", ".nan", "0.5", "true", "'0'", "null", "[0]", "{}", "1" * 4000],
    "layouts": ["nobody", "0", "null", "[ithor]", "ITHOR", "''"],
    "scenes": [
        *("0", "-1", "121", "1000000000000", "1.5", ".inf", "true", "null", "''", "[]", "{}", "FloorPlan1"),
        *("[FloorPlan999]", "[FloorPlan1, FloorPlan1]", "[1, 2]", "[null]", "[[FloorPlan1]]", "['../../etc/passwd']"),
        "[" + ", ".join(f"FloorPlan{i}" for i in range(10_000)) + "]",
        "['\\e[2J']",
    ],
    "configurations": ["0", "3", "33", "-4", "1.5", ".inf", "null", "true", "1000000000000"],
    "size_px": ["0", "31", "4097", "-150", "1.5", ".inf", "1000000000000", "null", "'150'"],
    "rgb_format": ["bmp", "JPEG", "null", "0", "[jpeg]"],
    "frames_per_configuration": ["0", "-1", "1.5", ".inf", "1000000000", "null"],
    "headings_deg": ["[]", "[1000000000]", "[.inf]", "[0.5]", "[null]", "90", "null", "['0']", f"[{'0, ' * 1000}]"],
    "horizons_deg": ["[]", "[91]", "[-1000000000]", "[.nan]", "[0.5]", "null", f"[{'0, ' * 1000}]"],
    "cells_per_frame": ["0", "-1", ".inf", "-.inf", ".nan", "1.0e+300", "null", "'1'", "[1]"],
    "train": ["null", "{}", "5", "[1, 2, 3]", "{EXISTENCE: 1}", "{EXISTENCE: 1, COUNTING: 1, SPATIAL: 1, OTHER: 1}"],
    "spare_groups": ["null", "{EXISTENCE: -1, COUNTING: 0, SPATIAL: 0}", "{EXISTENCE: .inf, COUNTING: 0, SPATIAL: 0}"],
    "test": ["{EXISTENCE: 100000000000, COUNTING: 0, SPATIAL: 0}", "{EXISTENCE: 1.5, COUNTING: 0, SPATIAL: 0}"],
}


def with_value(key: str, value: str) -> str:
    """The small configuration with another value."""
    lines = TINY.splitlines()
    (place,) = (i for i, line in enumerate(lines) if line.strip().startswith(f"{key}:"))
    return "\n".join([*lines[:place], f"{lines[place].partition(':')[0]}: {value}", *lines[place + 1 :]])


def configs() -> Iterator[tuple[str, str]]:
    yield from TEXTS.items()
    for key, values in VALUES.items():
        yield from ((f"{key}: {value[:40]}", with_value(key, value)) for value in values)
    for key in VALUES:
        yield f"no {key}", "\n".join(line for line in TINY.splitlines() if not line.strip().startswith(f"{key}:"))
        yield f"{key} in capitals", TINY.replace(f"{key}:", f"{key.upper()}:")


CONFIGS = dict(configs())


@pytest.mark.slow
@pytest.mark.parametrize("name", CONFIGS)
def test_a_configuration_that_cannot_be_used_is_one_line(name: str) -> None:
    started = time.process_time()
    with pytest.raises(ConfigError) as caught:
        parsed(Config, CONFIGS[name], "hostile.yaml")
    line = str(caught.value)
    assert line.startswith("hostile.yaml: ")
    assert line.isprintable(), line
    assert len(line) < 500, line
    assert time.process_time() - started < 2


def test_there_are_enough_of_them() -> None:
    assert len(CONFIGS) >= 120
    parsed(Config, TINY, "tiny.yaml")


@pytest.mark.parametrize("content", [b"seed: \xff", "seed: 0".encode("utf-16"), b"\x80" * 100])
def test_a_file_that_is_no_text_is_one_line(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "config.yaml"
    path.write_bytes(content)
    with pytest.raises(ConfigError, match=r"config\.yaml: not a text file"):
        load_config(path)

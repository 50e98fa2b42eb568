"""The code of README runs as it is."""

import pathlib
import re

ROOT = pathlib.Path(__file__).parents[2]


def test_readme(monkeypatch):
    monkeypatch.chdir(ROOT)
    blocks = re.findall("```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert blocks
    for block in blocks:
        names = {}
        exec(block, names)
        assert names["q"].shape == (1001, 2) and names["gravity"].solve().converged
        assert len(names["motions"]) == 5 and len(names["family"]) > 2 and names["arcs"].converged.all()

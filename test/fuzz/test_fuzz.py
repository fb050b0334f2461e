"""A short run of the fuzzer, the same every time; `make fuzz` is the long one."""

import fuzz
import pytest

INPUTS = 800
SLOW = {
    "images": 300,
    "files": 400,
    "meshes": 40,
    "bags": 200,
    "bundles": 200,
    "colors": 200,
    "selections": 100,
    "textures": 200,
    "onnx_edits": 300,
    "onnx_models": 150,
    "darknet_models": 200,
    "caffe_models": 200,
}  # inputs


@pytest.mark.parametrize("target", fuzz.ALL)
def test_nothing_falls_over_hostile_inputs(target, tmp_path):
    count = SLOW.get(target, INPUTS)
    failures = fuzz.fuzz(target, 1, count, float("inf"), str(tmp_path))
    assert not failures, "\n".join(failures)


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        ("import os; os.abort()", "it has ended with code -6"),
        ("while True: pass", "it hangs"),
        ("bytearray(1 << 40)", "MemoryError"),
        ("global kept; kept = b'x' * (500 << 20)", "MB are kept"),
        ("raise KeyError('x')", "KeyError"),
        ("raise ValueError('a\\nb')", "no line of text"),
    ],
)
def test_what_is_not_survived_is_told(code, reason, tmp_path, monkeypatch):
    broken = tmp_path / "worker.py"
    broken.write_text(
        f"import sys; sys.path.insert(0, {fuzz.HERE!r})\n"
        "import targets, worker\n"
        "class Broken(targets.Faces):\n"
        "    def run(self, data):\n"
        "        if data:\n"
        "            return\n"
        f"        {code}\n"
        "targets.TARGETS['faces'] = Broken\n"
        "worker.main()\n"
    )
    monkeypatch.setattr(fuzz, "HERE", str(tmp_path))
    worker = fuzz.Worker("faces")
    assert worker.take(b"good") == "taken"
    if reason == "it hangs":
        monkeypatch.setattr(fuzz, "MAX_CPU", 1.0)
    with pytest.raises(fuzz.SurvivalError, match=reason):
        worker.take(b"")
    worker.end()

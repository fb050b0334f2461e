"""The training of the network of config/networks: where it begins. It needs PyTorch."""

import pathlib
import sys

import pytest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
pytest.importorskip("torch")

from detector import train
from detector.training import Plan, Training

PLAN = Plan(seed=1, steps=4)


@pytest.fixture
def checkpoint(tmp_path):
    """That of a training whose steps are all done."""
    path = tmp_path / "checkpoint.pt"
    training = Training(PLAN, path)
    training.step = PLAN.steps
    training.save()
    return path


def test_a_training_that_has_ended_is_not_the_begin_of_another_one(checkpoint):
    ended = Training(PLAN, checkpoint)
    assert ended.step == PLAN.steps
    ended.finish()
    assert Training(PLAN, checkpoint).step == 0 and list(checkpoint.parent.iterdir()) == []


def test_a_training_says_from_where_it_goes_on(checkpoint, monkeypatch, capsys):
    for name in ("room_album", "table_album", "Album"):
        monkeypatch.setattr(train, name, lambda *_, **__: None)
    monkeypatch.setattr(Training, "run", lambda *_: None)
    folder = checkpoint.parent
    train.trained(PLAN, folder)
    assert capsys.readouterr().out == f"goes on from step 4 of 4, as {folder} has it\n"
    train.trained(PLAN._replace(steps=5), folder)  # another plan, which begins
    assert capsys.readouterr().out == ""

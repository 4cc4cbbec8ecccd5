"""What was measured is kept: of every processor, and of a run that was interrupted."""

from __future__ import annotations

import json

import pytest

from validation.benchmarks import __main__ as run
from validation.benchmarks import everyday
from validation.benchmarks.report import named

ROW = {
    "batch": 4096, "best_us_per_sample": 0.02, "best_pinocchio_us_per_sample": 1.0, "best_ratio": 50.0, "ratio": 49.0,
}  # fmt: skip


@pytest.fixture
def measuring(monkeypatch, tmp_path):
    """A run whose units take no time; the robots measured, in order."""
    asked = []

    def units(section, repetitions=5):
        def measure(robot):
            asked.append(robot)
            if robot == "panda" and asked.count("panda") == 1:
                raise KeyboardInterrupt
            return [{"robot": robot, "floating": False, "term": "rnea", **ROW}]

        return {robot: lambda robot=robot: measure(robot) for robot in ("ur5", "panda", "talos")}

    monkeypatch.setattr(run, "HERE", tmp_path)
    monkeypatch.setattr(run, "RESULTS", tmp_path / "results")
    (tmp_path / "results").mkdir()
    monkeypatch.setattr(run, "units", units)
    monkeypatch.setattr(run, "commit", lambda: "abc1234")
    monkeypatch.setattr("sys.argv", ["benchmarks", "--only", "main"])
    return asked


def on(monkeypatch, processor):
    machine = run.bench.machine() | {"processor": processor}
    monkeypatch.setattr(run.bench, "machine", lambda: machine)


def test_an_interrupted_run_goes_on_and_other_processors_keep_their_tables(monkeypatch, measuring, tmp_path):
    on(monkeypatch, "AMD EPYC (znver4)")
    with pytest.raises(KeyboardInterrupt):
        run.main()
    run.main()
    assert measuring == ["ur5", "panda", "panda", "talos"]
    run.main()
    assert len(measuring) == 4  # of this commit all is there
    first = (tmp_path / "results" / "amd-epyc-znver4.json").read_bytes()
    assert [r["robot"] for r in json.loads(first)["main"]] == ["ur5", "panda", "talos"]

    on(monkeypatch, "Intel(R) Xeon(R) Processor (rocketlake)")
    run.main()
    assert (tmp_path / "results" / "amd-epyc-znver4.json").read_bytes() == first
    index = (tmp_path / "results.md").read_text()
    for name in ("amd-epyc-znver4", "intel-xeon-processor-rocketlake"):
        assert f"results/{name}.md" in index and (tmp_path / "results" / f"{name}.md").exists()


def test_a_section_goes_on_for_the_same_commits_only(monkeypatch, tmp_path):
    monkeypatch.setattr(everyday, "HERE", tmp_path)
    (tmp_path / "everyday").mkdir()
    record = everyday.Record({"now": tmp_path})
    cold = record.begun("cold", 2, again=False)
    record.add("cold", cold, 0, "now", {"ur5 rnea | call": 0.2}, 1.0)
    again = everyday.Record({"now": tmp_path})
    found = again.begun("cold", 2, again=False)
    assert found["done"] == [[0, "now"]]
    again.add("cold", found, 1, "now", {"ur5 rnea | call": 0.1}, 1.0)
    assert again.sections["cold"]["rows"]["now"] == {"ur5 rnea | call": 0.1}  # the least
    assert again.begun("cold", 3, again=False)["done"] == again.begun("cold", 2, again=True)["done"] == []
    page = tmp_path / "everyday" / f"{named(again.machine['processor'])}.md"
    assert "| ur5 rnea | 0.1 |" in page.read_text()

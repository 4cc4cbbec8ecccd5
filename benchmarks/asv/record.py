"""Measure this commit in this environment and keep the result:  python benchmarks/asv/record.py [MACHINE]  (make asv)

On a machine that does nothing else, some two minutes.  Paths of the environment are left out of what is kept, so
that it reads the same wherever it was made.
"""

from __future__ import annotations

import json
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
RESULTS = ROOT / "benchmarks" / "asv" / "results"


def asv(*words: str, **options) -> None:
    subprocess.run([sys.executable, "-m", "asv", *words], cwd=ROOT, check=True, **options)


def main(machine: str) -> None:
    commit = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    environment = f"existing-py{platform.python_version_tuple()[0]}.{platform.python_version_tuple()[1]}"
    with tempfile.TemporaryDirectory() as folder:
        text = (ROOT / "asv.conf.json").read_text(encoding="utf-8")
        settings = Path(folder) / "asv.conf.json"
        text = text.replace('"benchmarks/asv/results"', json.dumps(f"{folder}/results"))
        text = text.replace('"benchmarks/asv"', json.dumps(str(ROOT / "benchmarks" / "asv")))
        settings.write_text(text.replace('"repo": "."', f'"repo": {json.dumps(str(ROOT))}'), encoding="utf-8")
        asv("machine", "--yes", "--machine", machine)
        asv("run", "--config", str(settings), "--python=same", "--machine", machine,
            "--set-commit-hash", commit.strip())  # fmt: skip
        for file in Path(folder, "results").rglob("*.json"):
            found = json.loads(file.read_text(encoding="utf-8"))
            name = file.name
            if "env_name" in found:
                found["env_name"], found["python"] = environment, platform.python_version()
                found["params"]["python"] = platform.python_version()
                name = f"{commit[:8]}-{environment}.json"
            place = RESULTS / file.parent.relative_to(Path(folder, "results")) / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(json.dumps(found) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else f"{platform.machine()}-{platform.system().lower()}")

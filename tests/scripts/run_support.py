"""What tests of `raymeter run` share."""
import csv
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

EMPTY_SCENE = "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 4 4\n"


def config(**changes) -> dict:
    document = {"name": "t", "matrix": {"scene": ["spd:balls:1", "spd:tetra:2"], "structure": [{"name": "list"}, {"name": "bvh"}], "isa": ["scalar"],
                                        "packet": [1, 16], "rays": ["primary", "shadow"]},
                "image": {"width": 32, "height": 32}, "measure": {"warmup": 1, "samples": 7}}
    for key, value in changes.items():
        if isinstance(value, dict):
            document.setdefault(key, {}).update(value)
        else:
            document[key] = value
    return document


class RunInFolder(unittest.TestCase):
    """Runs the executable in a folder of its own."""

    executable = ""

    def setUp(self) -> None:
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)

    def command(self, *words: str) -> list[str]:
        return [self.executable, *words]

    def raymeter(self, *words: str, **more) -> subprocess.CompletedProcess:
        return subprocess.run(self.command(*words), capture_output=True, text=True, cwd=self.folder, **more)

    def write(self, document: dict, name: str = "c.json") -> str:
        (self.folder / name).write_text(json.dumps(document))
        return name

    def rows(self, folder: Path, table: str) -> list[dict[str, str]]:
        with open(folder / f"{table}.csv", newline="") as file:
            return list(csv.DictReader(file))

    def samples(self, folder: Path) -> list[dict]:
        return [record for record in map(json.loads, (folder / "samples.jsonl").read_text().splitlines()) if record["type"] == "sample"]


def run_tests() -> None:
    """Usage of a test: TEST.py RAYMETER [UNITTEST ARGUMENTS]."""
    RunInFolder.executable = str(Path(sys.argv[1]).resolve())
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])

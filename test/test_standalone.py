"""The repository stands alone: nothing it reads lies beside it, and no test waits for what is not there."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from support.outside_paths import leading_out
from support.source_tree import DATA, ROOT

FOLDERS = ("test", "bench", "bags", "docs", "scripts", "launch", "config", "rapid", "requirements", ".ci")
SINGLE = ("Makefile", "activate", "README.md", "setup.py", "setup.cfg", "pyproject.toml", "package.xml")
TEXT = {".py", ".md", ".sh", ".yaml", ".json", ".xml", ".txt", ".toml", ".cfg", ".mod", ".rviz", ""}
FILES = sorted(
    path
    for path in [
        *(p for folder in FOLDERS for p in (ROOT / folder).rglob("*")),
        *(ROOT / "doormill_ros").rglob("*.py"),
        *(ROOT / "doormill_interfaces").rglob("*"),
        *(ROOT / name for name in SINGLE),
    ]
    if path.is_file() and path.suffix in TEXT and "__pycache__" not in path.parts
)
#: Names that tests give to the product to be refused, what a site has of its own, places of the operating system, a
#: file format whose paths are relative to its folder.
MEANT = {
    "docs/inspection.md": ["path .."],  # of a bag beside the inspection's folder, as the format says
    "doormill_ros/recipes/store/engine.py": [
        "Path(str(parsed.database)).expanduser()",
        "Path(url.database).expanduser()",
        "Path(text).expanduser()",
    ],
    "doormill_ros/resources.py": ["Path.home()", "Path(os.environ[SITE]).expanduser()"],
    # Where services put an installation and its site.
    "docs/living.md": [
        "place /opt/doormill",
        *["place /opt/doormill/deploy/doormill-run"] * 3,
        "place /opt/doormill/deploy/systemd",
        "place /usr/lib/sysusers.d/doormill.conf",
        "place /usr/lib/tmpfiles.d/doormill.conf",
        "place /var/backups/doormill",
        "place /var/backups/doormill.tar",
        *["place /var/backups/new.tar"] * 2,
        "place /var/lib/doormill",
        *["place /var/lib/doormill/today.tar"] * 3,
        "place ~/.cache/doormill_ros",
        "place ~/.local/share/doormill_ros",
        "place ~/.ros/log",
    ],
    # Places inside a machine or a container that the bench makes.
    "bench/booted.py": ["place /opt/doormill"],
    "bench/contained.py": ["place /opt/doormill/deploy/doormill-run"],
    "test/support/booted/campaign.py": [
        "place /opt/doormill/deploy/doormill-run",
        "place /opt/doormill/test/support/booted/goal.py",
        "place /var/backups/doormill",
        "place /var/lib/doormill",
        "place /var/lib/doormill/out/bags",
    ],
    "test/deploy/test_living_commands.py": [
        "place /opt/doormill/",
        "place /opt/doormill/*",
        "place /var/backups",
        "place /var/lib/doormill/",
        "place /var/lib/doormill/*",
    ],
    "test/support/booted/machine.py": ["place /opt/doormill", "place /usr/local/sbin"],
    # Where the operating system keeps the Python packages that belong to its own libraries.
    "docs/gige-camera.md": ["place /usr/lib/python3/dist-packages"],
    "doormill_ros/localization/gige/library.py": ["place /usr/lib/python3/dist-packages"],
    "test/test_docs.py": [
        "place /var/backups/doormill",
        "place /var/lib/doormill/out/targets",
    ],
    "test/deploy/test_container.py": ["place /opt/doormill", "place /opt/doormill/deploy/doormill-run"],
    "test/deploy/test_run.py": ["place /usr/local/bin"],
    "test/deploy/test_systemd.py": ["place /opt/doormill", "place /usr/bin"],
    "test/backup/test_archive.py": [
        "string '../evil'",
        "string 'config/../../evil'",
        "string 'config/a\\\\..\\\\..\\\\b/../c'",
    ],
    "scripts/relocate_wheels.py": ["place /opt/python/"],
    "test/diagnosis/parts/test_run.py": ["string '../bag'"],
    "test/robot_model/pose/test_link_masses.py": ["string '../robots/ur10'"],
    "test/support/hostile/mutations.py": ["string '../../../etc/passwd'"],
    "test/support/hostile/messages.py": ["string '../../../etc/passwd'"],
    "test/abb/test_transport_rws.py": ["string '../x'"],
    "test/recipes/test_bad_recipes.py": ["string '../etc/passwd'"],
    "test/simulation/controller/test_rapid_library.py": [
        "string 'Open \"HOME:../f.txt\", f \\\\Read;'",
        "string 'Open \"HOME:/../../f.txt\", f \\\\Read;'",
    ],
    "test/simulation/controller/test_rws_server.py": [
        "string '$home/../secret.txt'",
        "string '$home/..%2fsecret.txt'",
    ],
    "test/support/postgres.py": ["place /usr/lib/postgresql"],
}
BAD = {
    "test/deep/test_it.py": """
from pathlib import Path
from support.source_tree import ROOT
HERE = Path(__file__).resolve().parent
A = Path(__file__).resolve().parents[3] / "facts.yaml"
B = HERE.parent.parent.parent
C = ROOT.parent
D = ROOT / "test/../../facts.yaml"
def test_it(request):
    assert (request.config.rootpath / "../facts.yaml").is_file() or (somewhere / "..").is_dir()
    assert Path("/home/somebody/facts.yaml").read_text() or Path.home() or "see ~/facts"
""",
    "bench/series.py": "print('--data', '../series')\n",
    "bench/run.py": "from pathlib import Path\nprint(Path(__file__).parent.parent.parent, '--data ../series')\n",
    "docs/page.md": "[text](../../beside.md)\n`diagnose ../series` and `cat /work/facts`\n",
    "scripts/go.sh": 'cd "$(dirname "$0")/../.."\n',
    "Makefile": "run:\n\tcd .. && ls\n",
}
GOOD = {
    "test/deep/test_it.py": """
from pathlib import Path
from support.source_tree import DATA, ROOT
A = Path(__file__).resolve().parents[2] / "docs" / "a.md"
E = "../test_that.py"
B = DATA.parent.parent, "1..22 and so on...", "/door/pose"
""",
    "test/test_that.py": "",
    "docs/page.md": "[text](../README.md), 100..199\n",
    "scripts/go.sh": 'cd "$(dirname "$0")/.."\n',
}


def relative(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def test_the_scan_sees_the_repository() -> None:
    seen = {relative(path) for path in FILES}
    assert {"Makefile", ".ci/run", "docs/diagnosis-ur10.md", "bench/diagnosis_ur10.py"} <= seen
    assert {"test/diagnosis/pose/test_ur10.py", "bags/make_bags.py", "scripts/bootstrap.sh"} <= seen
    assert len(seen) > 600


def test_no_path_leaves_the_repository() -> None:
    itself = {Path(__file__).resolve(), ROOT / "test" / "support" / "outside_paths.py"}
    found = {relative(path): sorted(leading_out(ROOT, path)) for path in FILES if path not in itself}
    assert {name: leaks for name, leaks in found.items() if leaks} == {
        name: sorted(meant) for name, meant in MEANT.items()
    }


def write(folder: Path, files: dict[str, str]) -> dict[str, list[str]]:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return {name: leading_out(folder, folder / name) for name in files}


def test_the_scan_finds_what_leaves(tmp_path: Path) -> None:
    found = write(tmp_path, BAD)
    assert len(found["docs/page.md"]) == 3
    assert {name for name, leaks in found.items() if not leaks} == set()
    python = " ".join(found["test/deep/test_it.py"])
    for part in (
        "parents[3]",
        "HERE.parent.parent",
        "ROOT.parent",
        "test/../../facts",
        "rootpath / '../",
        "somewhere / '..'",
    ):
        assert part in python
    for part in ("/home/somebody", "Path.home()", "~/facts"):
        assert part in python


def test_the_scan_lets_pass_what_stays(tmp_path: Path) -> None:
    assert write(tmp_path, GOOD) == {name: [] for name in GOOD}


def test_no_file_speaks_of_the_workplace() -> None:
    """The project speaks of the project alone."""
    words = ("/work/", "shared/contracts", "helper-", "issues show", "claude", "anthropic")
    found = {
        relative(path): [w for w in words if w in path.read_text(encoding="utf-8").lower()]
        for path in FILES
        if path != Path(__file__).resolve()
    }
    assert {name: said for name, said in found.items() if said} == {}


def skipping(text: str) -> set[str]:
    """Names by which a test file may leave tests out."""
    names = {getattr(node, "attr", getattr(node, "id", "")) for node in ast.walk(ast.parse(text))}
    return names & {"skip", "skipif", "importorskip", "xfail", "skipTest", "SkipTest"}


def test_no_test_is_left_out() -> None:
    """What is missing fails with a sentence; a test that is skipped says nothing."""
    assert skipping("import pytest\npytestmark = pytest.mark.skipif(True, reason='')") == {"skipif"}
    files = sorted((ROOT / "test").rglob("*.py"))
    assert len(files) > 150
    assert {relative(path): skipping(path.read_text(encoding="utf-8")) for path in files} == {
        relative(path): set() for path in files
    }


#: Files that are collected only where what they need is installed, and the page that says so.
COLLECTED_WHERE = {
    "test/deploy/launched/conftest.py": "docs/living.md",
    "test/localization/gige/conftest.py": "docs/gige-camera.md",
    "test/nodes/gige/conftest.py": "docs/gige-camera.md",
}


def test_files_that_are_not_always_collected_are_told_of() -> None:
    leaving = {
        relative(path)
        for path in (ROOT / "test").rglob("*.py")
        if path != Path(__file__).resolve() and "collect_ignore" in path.read_text(encoding="utf-8")
    }
    assert leaving == COLLECTED_WHERE.keys()
    for name, page in COLLECTED_WHERE.items():
        assert f"`{Path(name).parent}`" in (ROOT / page).read_text(encoding="utf-8"), (name, page)


@pytest.mark.parametrize("entry", sorted(path.name for path in DATA.iterdir() if path.name != "README.md"))
def test_data_name_their_origin_and_licence(entry: str) -> None:
    row = re.search(rf"^\| `{re.escape(entry)}[`/].*$", (DATA / "README.md").read_text("utf-8"), re.MULTILINE)
    assert row, f"{entry} is not in test/data/README.md"
    if "MIT" in row[0]:
        licence = (DATA / entry / "LICENSE.md").read_text("utf-8")
        assert licence.startswith("MIT License")
        assert "Copyright (c)" in licence

# SPDX-License-Identifier: Apache-2.0
"""What all commands do alike: a mistake is one line and status 2, help names every option, make passes what is set."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from scripts import compare, coverage, follow, formal, run, soak
from scripts.fpga import measure
from scripts.pages import wordlengths
from scripts.playground import page as playground
from scripts.report import page
from tb.core import hardest
from tb.sim.env import ROOT, environment

MAINS = {
    "run": run.main, "follow": follow.main, "report": page.main, "soak": soak.main,
    "compare": compare.main, "wordlengths": wordlengths.main, "formal": formal.main, "fpga": measure.main,
    "playground": playground.main, "coverage": coverage.main,
}  # fmt: skip

WHOLE = "is not a whole number of at least"
CORE = [
    ("--sim modelsim", "--sim", "unknown simulator 'modelsim'", "icarus, verilator"),
    ("--datapath lean2", "--datapath", "unknown datapath 'lean2'", "paper"),
    ("--width 33", "--width", "unknown width '33'", "16 to 32"),
    ("--width 15", "unknown width '15'"),
    ("--width x", "unknown width 'x'"),
    ("--datapath fold --width 23", "--width: the fold datapath has words of 20, 22, 24, 26, 28, 30 or 32 bits only"),
    ("--speed 9", "unrecognized arguments: --speed 9"),
    ("--out", "--out", "expected one argument"),
    ("--out=", "--out", "the name of a folder is empty"),
    ("--out file", "--out", "'file'", "File exists"),
    ("--out file/sub", "--out", "'file/sub'", "Not a directory"),
]
SEVERAL = [
    ("--datapath lean,lean2", "--datapath", "unknown datapath 'lean2'"),
    ("--datapath lean,", "--datapath", "unknown datapath ''"),
    ("--datapath lean,lean", "--datapath: 'lean,lean' is not up to 3 different ones"),
    ("--datapath lean,fold,paper,short", "--datapath: 'lean,fold,paper,short' is not up to 3 different ones"),
    ("--datapath lean,fold --width 23", "--width: the fold datapath has words of 20, 22, 24, 26, 28, 30 or 32 bits"),
]
TRAJECTORIES = [
    ("--trajectory reech", "--trajectory", "'reech'", "all, reach, circle", "CSV file"),
    ("--cores fast", "--cores", "unknown cores 'fast'", "behavioural, digit"),
    ("--trajectory t.csv --d1 0", "--d1", "'0' is not positive"),
    ("--trajectory t.csv --d2 -1", "--d2", "'-1' is not positive"),
    ("--trajectory t.csv --d1 nan", "--d1", "'nan' is not a finite number"),
    ("--trajectory t.csv --phi abc", "--phi", "'abc' is not a number"),
    ("--trajectory reach --d1 0.4", "--d1", "reach"),
    ("--trajectory all --phi 1", "--phi", "all"),
    ("--traj reach", "unrecognized arguments: --traj reach"),
    ("--trajectory none.csv", "none.csv: no such file"),
    ("--trajectory none.CSV", "none.CSV: no such file"),
    ("--trajectory none/none", "none/none: no such file"),
    ("--trajectory folder", "folder: is a directory"),
    ("--bar 0", "--bar", "'0' is not positive"),
    ("--bar high", "--bar", "'high' is not a number"),
    ("--axis up", "--axis", "axis 'up' is none of z, -z, x"),
    ("--axis 1,2", "--axis", "axis '1,2' is no vector of three"),
    ("--axis torso", "--axis: torso goes with a BVH clip, not with a built-in trajectory (reach)"),
    ("--trajectory t.csv --axis torso", "--axis: torso goes with a BVH clip, not with a CSV file"),
    ("--trajectory t.csv --phi clip", "--phi: clip goes with a BVH clip"),
    ("--trajectory t.csv --phi constant", "--phi: constant goes with a BVH clip"),
    ("--trajectory t.csv --arm left", "--arm: goes with a BVH clip, not with a CSV file (t.csv)"),
    ("--joints a,b,c", "--joints: goes with a BVH clip, not with a built-in trajectory (reach)"),
    ("--trajectory none.bvh", "none.bvh: cannot be read: No such file"),
    ("--trajectory none.bvh --d1 1", "--d1: goes with a CSV file, not with a BVH clip"),
    ("--trajectory none.bvh --arm up", "--arm", "unknown arm 'up'; valid: both, left, right"),
]
SAMPLE = [
    ("--targets 0", "--targets", f"'0' {WHOLE} 1"),
    ("--targets many", "--targets"),
    ("--seed -1", "--seed"),
    ("--seed x", "--seed", f"'x' {WHOLE} 0"),
]
MISTAKES = {
    "run": CORE + SEVERAL + TRAJECTORIES + [("--out o", "--out", "'o/score.json' is a folder")],
    "report": CORE + SEVERAL + TRAJECTORIES + [
        ("--waves", "unrecognized arguments: --waves"), ("--out o", "--out", "'o/report.html' is a folder"),
    ],
    "follow": [(f"--target 0 --waves {words}", *parts) for words, *parts in CORE + TRAJECTORIES] + [
        ("", "the following arguments are required: --target"),
        ("--target -1", "--target", f"'-1' {WHOLE} 0"),
        ("--target 1e1", "--target", f"'1e1' {WHOLE} 0"),
        ("--target 100", "argument --target: reach has targets 0 to 99, not 100"),
        ("--target 1 --trajectory t.csv", "argument --target: t has targets 0 to 0, not 1"),
        ("--target 0 --trajectory all", "argument --trajectory: one trajectory, not all of them"),
    ],
    "soak": CORE + SAMPLE + [
        ("--targets -5", "--targets"),
        ("--targets 1e6", "--targets", "'1e6'"),
        (f"--targets {'9' * 400}", "--targets"),
        ("--from -1", "--from"),
        ("--from 1.5", "--from", f"'1.5' {WHOLE} 0"),
        ("--again none.csv", "none.csv: cannot be read: No such file"),
        *((f"--again file {option}", option.split()[0], "--again")
          for option in ("--targets 5", "--seed 0", "--keep", "--from 0", "--width 18",
                          "--farm tcp://x:1")),
        *((f"--farm {text}", "--farm", "is not the address of a scheduler, as in tcp://scheduler:8786")
          for text in ("x", "tcp://", "tcp://x", "x:8786", "tcp://x:0", "tcp://x:65536", "tcp://x:8786/", "tls://x:1")),
        ("--out o", "--out", "'o/hardest.csv' is a folder"),
    ],
    "coverage": [
        ("--only x --keep", "argument --keep: not with --only"),
        ("--only x --again", "argument --again: not with --only"),
        ("--out o", "unrecognized arguments: --out o"),
    ],
    "compare": SAMPLE,
    "wordlengths": SAMPLE,
    "formal": [("--only nothing", "argument --only: no proof or node 'nothing'; --list says which there are")],
    "playground": [
        ("--datapath short", "--datapath", "unknown datapath 'short'; valid: lean, fold, fold16, paper"),
        ("--width 17", "no such machine; there are lean-W32, "),
        ("--datapath fold --width 18", "--width: the fold datapath has words of"),
        ("--out=", "--out", "the name of a folder is empty"),
    ],
    "fpga": [
        ("--width 33", "unknown width '33'"),
        ("--datapath lean2", "unknown datapath 'lean2'"),
        ("--datapath lean --datapath short --width 18", "--width: the short datapath has words of 32 bits only"),
    ],
}  # fmt: skip


@pytest.mark.parametrize(("name", "arguments"), [(name, words) for name, of in MISTAKES.items() for words, *_ in of])
def test_a_mistake_is_one_line_and_status_2(command, files, monkeypatch, tmp_path, name, arguments):
    """And nothing is simulated or written."""
    for module in (run, follow):
        monkeypatch.setattr(module, "simulate", lambda *_, **__: pytest.fail("simulates"))
    monkeypatch.setattr(soak.Core, "built", lambda *_: pytest.fail("simulates"))
    monkeypatch.setattr(hardest, "LIST", tmp_path / "kept.csv")
    for folder in ("folder", "o/score.json", "o/report.html", "o/hardest.csv"):
        Path(folder).mkdir(parents=True)
    Path("file").touch()
    Path("t.csv").write_text("x,y,z\n0.3,0.1,-0.2\n", encoding="utf-8")
    status, out, err = command(MAINS[name], *arguments.split())
    assert (status, out, len(err)) == (2, [], 1), err
    (parts,) = [parts for words, *parts in MISTAKES[name] if words == arguments]
    assert err[0].startswith(f"{name}: ") and all(part in err[0] for part in parts), err
    assert files() == ["file", "t.csv"] and not Path("build").exists()


OPTIONS = {
    "run": "trajectory out sim datapath width cores waves d1 d2 phi bar list",
    "follow": "target trajectory out sim datapath width cores waves d1 d2 phi bar",
    "report": "trajectory out sim datapath width d1 d2 phi",
    "soak": "targets seed from datapath width sim jobs out keep again",
    "compare": "targets seed",
    "coverage": "only again keep",
    "wordlengths": "targets seed",
    "playground": "out datapath width",
}


@pytest.mark.parametrize("name", OPTIONS)
def test_help_names_every_option(name, capsys):
    with pytest.raises(SystemExit) as stopped:
        MAINS[name](["--help"])
    said = capsys.readouterr().out
    assert stopped.value.code == 0 and "Exit status: 0 " in said
    assert all(f"\n  --{option}" in said for option in OPTIONS[name].split())
    if name == "report":
        assert "report.html" in said and "build/report" in said


@pytest.mark.parametrize(
    ("module", "arguments", "said"),
    [
        ("run", "--trajectory none.csv", "run: none.csv: no such file\n"),
        ("report", "--trajectory none.csv", "report: none.csv: no such file\n"),
        ("soak", "--width 3", "soak: argument --width: unknown width '3'; valid: 16 to 32 bits\n"),
    ],
)
def test_as_a_command(module, arguments, said):
    """A mistake is refused before any simulator is looked for, with the exit status of the process."""
    words = [sys.executable, "-m", f"scripts.{module}", *arguments.split()]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr[: len(said)]) == (2, "", said)


# -- what make passes ------------------------------------------------------------------------------


def made(*words):
    """The commands that make would start: what set-up is told, and the last one's words."""
    env = {name: value for name, value in environment().items() if name != "SIM"}
    done = subprocess.run(["make", "-n", *words], cwd=ROOT, env=env, capture_output=True, text=True, check=True)
    said = done.stdout.replace("\\\n", " ")
    return re.findall(r"bootstrap.py (.*)", said), said.split(" -m scripts.")[1].split()


def test_make_soak():
    assert made("soak") == (["verilator"], ["soak", "--sim", "verilator"])
    assert made("soak", "SIM=icarus")[1] == ["soak", "--sim", "icarus"]
    assert made("soak", "KEEP=")[1] == ["soak", "--sim", "verilator"]
    words = "TARGETS=9 SEED=2 DATAPATH=lean WIDTH=18 OUT=o AGAIN=f FROM=3 FARM=x KEEP=1"
    options = [f'--{o}="$CGA_{o.upper()}"' for o in "targets seed datapath width out again from farm".split()]
    assert made("soak", *words.split()) == (["verilator farm"], ["soak", "--sim", "verilator", *options, "--keep"])


def test_make_mutants():
    assert made("mutants") == (["icarus fpga"], ["mutants"])
    options = [f'--{o}="$CGA_{o.upper()}"' for o in "count seed only out farm".split()]
    made_by = made("mutants", "COUNT=9", "SEED=2", "ONLY=lib", "OUT=o", "FARM=x", "KEEP=1")
    assert made_by == (["icarus fpga farm"], ["mutants", *options, "--keep"])


def test_make_coverage():
    assert made("coverage") == (["verilator coverage"], ["coverage"])
    assert made("coverage", "ONLY=x y", "KEEP=1")[1] == ["coverage", '--only="$CGA_ONLY"', "--keep"]


def test_make_farm_worker():
    """Set up for all that it may be given."""
    assert made("farm-worker", "FARM=x") == (["icarus verilator fpga farm"], ["farm", '--farm="$CGA_FARM"'])


def test_make_report_and_follow_are_started_as_make_run():
    words = "TRAJECTORY=all OUT=o DATAPATH=paper WIDTH=32 D1=0.3 D2=0.2 PHI=-0.5 BAR=1e-4 SIM=verilator".split()
    (needs, (_, *options)), report = made("run", *words, "WAVES=1"), made("report", *words)
    assert options[-1] == "--waves" and report == (needs, ["report", *options[:-1]])
    follows = ["follow", *options[:-1], '--target="$CGA_TARGET"', "--waves"]
    assert made("follow", *words, "WAVES=1", "TARGET=42") == (needs, follows)


def refused(*words, cwd=ROOT):
    """What make says instead of starting anything."""
    done = subprocess.run(
        ["make", "-n", *words], cwd=cwd, env=environment(), capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), done
    return done.stderr.split("*** ")[1].removesuffix(".  Stop.\n")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("run sim=verilator", "make run takes no variable sim: perhaps SIM is meant"),
        ("run WIDHT=18", "make run takes no variable WIDHT: perhaps WIDTH is meant"),
        ("report WAVES=1", "make report takes no variable WAVES: it takes ARM, AXIS, BAR, CORES, D1, D2, DATAPATH, "),
        ("compare TRAJECTORY=reach", "make compare takes no variable TRAJECTORY: it takes none"),
        ("soak D1=3", "make soak takes no variable D1: it takes AGAIN, AGAINST, DATAPATH, FARM, FROM, KEEP, OUT, "),
        ("run WAVES=no", "WAVES=no: use 1 or 0"),
        ("soak KEEP=yes", "KEEP=yes: use 1 or 0"),
        ("X=1", "make help takes no variable X: it takes none"),
    ],
)
def test_make_refuses_variables_of_no_use(words, said):
    assert refused(*words.split()).startswith(said)


def test_make_starts_commands_in_the_place_of_the_shell():
    """Else a SIGTERM to make would end the shell, and the command with its simulator would run on."""
    text = (ROOT / "Makefile").read_text()
    starts = re.findall(r"^(?:\t@|pytest ).*\$\(VENV\) .*$", text, re.MULTILINE)
    assert len(starts) > 15 and all("exec $(VENV) " in line for line in starts)


def test_make_from_another_folder(tmp_path):
    """Paths are as seen from there; what works on the checkout does not begin."""
    words = ["make", "-n", "-f", str(ROOT / "Makefile")]
    env = environment() | {"SIM": "icarus"}
    done = subprocess.run([*words, "run"], cwd=tmp_path, env=env, capture_output=True, text=True, check=True)
    assert f"exec env PYTHONPATH={ROOT}/ {ROOT}/.venv/bin/python -m scripts.run" in done.stdout
    assert refused("-f", str(ROOT / "Makefile"), "clean", cwd=tmp_path).startswith("make clean works in its own folder")

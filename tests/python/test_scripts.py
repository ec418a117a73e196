"""The shell scripts, with stand-ins for what they call: which files they name, and where. Nothing is built."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import fmi3_support

ROOT = Path(__file__).resolve().parents[2]
# Says where it was called, and with what.
STAND_IN = """#!/bin/sh
echo "$(basename "$0") in $PWD:" "$@" >>"{log}"
"""


class Project(unittest.TestCase):
    """A copy of the scripts in a folder of its own, and a caller somewhere else."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name).resolve()
        self.root, self.caller, self.built, self.log = (self.folder / name for name in ("project", "caller", "built", "log"))
        self.caller.mkdir()
        shutil.copytree(ROOT / "scripts", self.root / "scripts", ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("scripts/setup.sh", "scripts/tools/build_fmu_library.sh", "target/venv/bin/python"):
            self.stand_in(self.root / name)
        self.stand_in(self.folder / "bin" / "cargo")
        for target in (self.root / "target", self.built):
            self.stand_in(target / "release" / "ugv")

    def stand_in(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(STAND_IN.format(log=self.log))
        path.chmod(0o755)

    def call(self, script: str, *words: str, status: int = 0, cwd: Path | None = None, **more: str) -> str:
        """Calls a script from the caller's folder; what it said as an error."""
        self.log.write_text("")
        kept = {name: value for name, value in os.environ.items() if name != "CARGO_TARGET_DIR" and not name.startswith("UGV_")}
        done = subprocess.run([script if script.startswith("./") else self.root / "scripts" / script, *words], cwd=cwd or self.caller, capture_output=True, text=True, check=False,
                              env=kept | {"PATH": f"{self.folder / 'bin'}:{kept['PATH']}"} | more)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stderr

    def called(self, program: str) -> list[str]:
        """The calls of a program: where, and with what; in short."""
        short = {str(self.root / "scripts" / ".."): "ROOT", str(self.root): "ROOT", str(self.caller): "CALLER", str(self.built): "BUILT"}
        text = self.log.read_text()
        for path, name in short.items():
            text = text.replace(path, name)
        return [line.removeprefix(f"{program} in ") for line in text.splitlines() if line.startswith(f"{program} in ")]


class Package(Project):
    def outputs(self, *words: str, **more: str) -> list[str]:
        """Version of FMI and FMU of what is packaged, and what else the tool is told."""
        self.call("package.sh", *words, **more)
        return [call.partition("ugv.so ")[2] for call in self.called("ugv")]

    def test_both_fmus_are_made_in_target(self) -> None:
        self.assertEqual(self.outputs("--terrain", "dry_sand"), ["--terrain dry_sand --fmi 3 --output ROOT/target/ugv-fmi3.fmu",
                                                                 "--terrain dry_sand --output ROOT/target/ugv.fmu"])

    def test_an_output_names_both(self) -> None:
        expected = ["--vehicle mine.json --fmi 3 --output mine-fmi3.fmu", "--vehicle mine.json --output mine.fmu"]
        for words in (["--output", "mine.fmu"], ["--output=mine.fmu"], ["-o", "mine.fmu"], ["-omine.fmu"], ["-o=mine.fmu"]):
            for order in ([*words, "--vehicle", "mine.json"], ["--vehicle", "mine.json", *words]):
                self.assertEqual(self.outputs(*order), expected, order)

    def test_zig_is_set_up_where_the_library_is_handed_on(self) -> None:
        for words, group, portable in (([], "", ""), (["--portable"], "platforms", "--portable"), (["--platforms", "darwin64"], "platforms", "--portable")):
            self.call("package.sh", *words)
            (setup,), (build,) = self.called("setup.sh"), self.called("build_fmu_library.sh")
            self.assertEqual(setup, f"CALLER: {group}".strip(), words)
            platform = words[1] if len(words) > 1 else "linux64"
            self.assertEqual(build, f"CALLER: {platform} {portable}".strip(), words)

    def test_what_only_the_tool_does_is_refused_before_anything_is_built(self) -> None:
        for words in (["--fmi", "3"], ["--fmi=2"], ["--merge", "a.fmu", "b.fmu", "--output", "c.fmu"]):
            self.assertIn("use target/release/ugv package", self.call("package.sh", *words, status=1))
            self.assertEqual(self.log.read_text(), "")
        for words in (["--output"], ["-o"], ["--output="]):
            self.assertIn("--output needs a file", self.call("package.sh", *words, status=1))

    def test_it_goes_where_cargo_builds(self) -> None:
        for place in (str(self.built), "../built"):
            first, second = self.outputs(CARGO_TARGET_DIR=place)
            self.assertEqual([Path(call.split()[-1].replace("CALLER/../built", "BUILT")) for call in (first, second)],
                             [Path("BUILT/ugv-fmi3.fmu"), Path("BUILT/ugv.fmu")])


class Callers(Project):
    """Paths that are given are the caller's; what is not given is the project's."""

    def setUp(self) -> None:
        super().setUp()
        self.stand_in(self.root / "scripts" / "package.sh")

    def python(self) -> str:
        """The one call of Python."""
        (call,) = self.called("python")
        return call

    def test_prove(self) -> None:
        for words, expected in ((["draw", "--out", "cases"], "CALLER: -m generator --out cases"),
                                (["--page"], "CALLER: -m judge --tool ROOT/target/release/ugv --page"),
                                (["altered"], "CALLER: -m altered --tool ROOT/target/release/ugv")):
            self.call("prove.sh", *words)
            self.assertEqual(self.python(), expected)
            self.assertEqual([call.partition(":")[0] for call in self.called("cargo")], ["ROOT"] * (words[0] != "draw"))
        self.call("prove.sh", "agree", UGV_TOOL="mine/ugv")
        self.assertEqual(self.python(), "CALLER: -m agreement --tool mine/ugv")
        self.call("prove.sh", "agree", CARGO_TARGET_DIR=str(self.built))
        self.assertEqual(self.python(), "CALLER: -m agreement --tool BUILT/release/ugv")
        self.call("prove.sh", "draw", "--out", "target/example", cwd=self.root)
        self.assertEqual(self.python(), "ROOT: -m generator --out target/example")

    def test_a_module_of_the_caller_s_is_not_taken_for_ours(self) -> None:
        (self.caller / "generator.py").write_text("raise SystemExit(7)\n")
        python = self.root / "target" / "venv" / "bin" / "python"
        asked = "import importlib.util as u; print(u.find_spec('generator').origin)"
        python.write_text(f'#!/bin/sh\nexec "{sys.executable}" -c "{asked}" >"{self.log}"\n')
        self.call("prove.sh", "draw", "--out", "cases")
        self.assertEqual(Path(self.log.read_text().strip()), self.root / "scripts" / "proof" / "generator" / "__init__.py")

    def test_importers(self) -> None:
        self.call("tools/importers.sh", "--fmu", "mine.fmu", "--page", "page.md")
        self.assertEqual(self.python(), "CALLER: ROOT/scripts/tools/importers/matrix.py --native ROOT/target/release/examples/held_drive "
                                        "--fmu mine.fmu --page page.md")
        self.assertEqual([call.partition(":")[0] for call in self.called("cargo")], ["ROOT"])
        self.call("tools/importers.sh", "fmpy", UGV_HELD_DRIVE="mine", CARGO_TARGET_DIR=str(self.built))
        self.assertEqual(self.python(), "CALLER: ROOT/scripts/tools/importers/matrix.py --native mine fmpy")
        self.assertEqual(self.called("package.sh"), ["ROOT:"])

    def test_controllers(self) -> None:
        for example in ("slip_control", "slalom"):
            # As if its environment were installed.
            requirements = self.root / "scripts" / "examples" / "controllers" / example / "requirements.txt"
            venv = self.root / "target" / ("venv-ssp" if example == "slip_control" else "venv-slalom")
            self.stand_in(venv / "bin" / "python")
            line = f'echo "$(python3 -V) {self.root} $(sha256sum <"{requirements}")" >"{venv}/stamp"'
            subprocess.run(["sh", "-c", line], check=True)
        self.call("examples/controllers.sh", "slalom", "--fmu", "mine.fmu")
        self.assertEqual(self.python(), "CALLER: -m controllers.slalom --fmu mine.fmu")
        self.call("examples/controllers.sh", "slip_control", "--output", "here")
        self.assertEqual(self.python(), "CALLER: -m controllers.slip_control --libcosim ROOT/target/venv-ssp/bin/python --output here")
        (self.built / "fmu").mkdir()
        (self.built / "fmu" / "ugv.so").touch()
        self.call("examples/controllers.sh", "slip_control", CARGO_TARGET_DIR=str(self.built))
        self.assertEqual(self.python(), "CALLER: -m controllers.slip_control --libcosim ROOT/target/venv-ssp/bin/python "
                                        "--ugv BUILT/controllers/ugv.fmu")
        (packaged,) = self.called("ugv")
        self.assertIn("--library linux64=BUILT/fmu/ugv.so", packaged)
        # Without an example it tells which there are, wherever it is called.
        usage = self.call("./controllers.sh", status=2, cwd=self.root / "scripts" / "examples")
        self.assertIn("scripts/examples/controllers.sh slalom [--help]", usage)

    def test_soak(self) -> None:
        (self.caller / "mine.fmu").touch()
        self.assertIn("nowhere.fmu is not there", self.call("tools/soak.sh", UGV_FMU="nowhere.fmu", status=1))
        # What stands in for Python unpacks nothing.
        self.call("tools/soak.sh", UGV_FMU="mine.fmu", status=2)
        self.assertIn("-e CALLER/mine.fmu ", self.python())
        (self.built / "ugv.fmu").touch()
        self.call("tools/soak.sh", CARGO_TARGET_DIR=str(self.built), status=2)
        self.assertIn("-e BUILT/ugv.fmu ", self.python())
        self.assertIn("soak.sh [--steps N]", subprocess.run(["./soak.sh", "--help"], cwd=self.root / "scripts" / "tools", capture_output=True, text=True,
                                                            check=True).stdout)

    def test_bench(self) -> None:
        self.stand_in(self.folder / "bin" / "gcc")
        # What stands in for Python unpacks nothing.
        self.call("tools/bench.sh", CARGO_TARGET_DIR="../built", status=2)
        told = [call.replace("CALLER/../built", "BUILT") for call in self.called("python")]
        self.assertEqual(told, ["ROOT: -m zipfile -e BUILT/ugv.fmu BUILT/bench/fmu"])
        self.assertEqual([call.replace("CALLER/../built", "BUILT") for call in self.called("cargo")], ["ROOT: bench --locked --bench model -- BUILT/bench"])


class Setup(unittest.TestCase):
    """scripts/setup.sh and its groups."""

    def test_every_package_of_a_group_has_a_version(self) -> None:
        folder = ROOT / "scripts" / "requirements"
        names = {path.stem: [line for line in path.read_text().splitlines() if not line.startswith("#")] for path in folder.glob("*.txt")}
        pinned = {line.partition("==")[0] for line in names.pop("constraints")}
        self.assertEqual(set(names), {"base", "demo", "proof", "scale", "platforms", "test"})
        for group, packages in names.items():
            self.assertEqual(set(packages) - pinned, set(), group)

    def test_a_group_that_is_not_there_is_refused(self) -> None:
        done = subprocess.run([ROOT / "scripts" / "setup.sh", "demos"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("there is no group demos; there are demo, proof", done.stderr)

    def test_the_index_names_every_script(self) -> None:
        index = (ROOT / "scripts" / "README.md").read_text()
        for folder in ("", "examples", "tools"):
            for path in (ROOT / "scripts" / folder).iterdir():
                if path.suffix in (".sh", ".py"):
                    self.assertIn(f"`{path.name}`", index)


class Defaults(unittest.TestCase):
    """What Python scripts take when nothing is named."""

    def test_what_is_built_is_where_cargo_builds(self) -> None:
        asked = """
import bench_sweep, bench_table, fleet, path_follower, recordings_report, sweep
from controllers.slalom import environment
from controllers.slip_control import __main__ as slip_control
import matrix
ours = bench_sweep, bench_table, fleet, path_follower, recordings_report, sweep, slip_control
print(*(module.TARGET for module in ours), environment.FMU.parent, matrix.BUILT)
print(matrix.TARGET)
"""
        path = os.pathsep.join(str(ROOT / "scripts" / name) for name in ("examples", "tools", "tools/importers"))
        said = subprocess.run([sys.executable, "-c", asked], env=os.environ | {"PYTHONPATH": path, "CARGO_TARGET_DIR": "/built"},
                              capture_output=True, text=True, check=True).stdout
        built, environments = said.splitlines()
        self.assertEqual(built.split(), ["/built"] * 9)
        self.assertEqual(environments, str(ROOT / "target"))

    def test_tests_take_both_fmus_of_one_output(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            for fmu in ("linux.fmu", "linux-fmi3.fmu", "other.fmu"):
                (Path(name) / fmu).touch()
            for two, three in (("linux.fmu", Path(name) / "linux-fmi3.fmu"), ("other.fmu", Path(name) / "target" / "ugv-fmi3.fmu")):
                three.parent.mkdir(exist_ok=True)
                three.touch()
                with mock.patch.object(fmi3_support, "TARGET", Path(name) / "target"), mock.patch.dict(os.environ, UGV_FMU=str(Path(name) / two)):
                    os.environ.pop("UGV_FMI3", None)
                    self.assertEqual(fmi3_support.fmi3_path(), three)


if __name__ == "__main__":
    unittest.main()

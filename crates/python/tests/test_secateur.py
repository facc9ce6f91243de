"""What Python's users do with secateur, held against the program. SECATEUR names the program."""

import hashlib
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy as np

import secateur

PROGRAM = os.environ["SECATEUR"]


def run(*words, code=0):
    """What the program prints with these words."""
    ran = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
    assert ran.returncode == code, ran.stderr
    return ran.stdout


class WithOak(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        cls.file = cls.folder / "oak.glb"
        run("grow", "oak", "--leaves", 240, "--seed", 5, "-o", cls.file)
        cls.oak = secateur.open(cls.file)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()


class SameAsTheProgram(WithOak):
    def test_a_level_has_the_bytes_and_hashes_of_the_program(self):
        few = ["--views", "6", "--resolution", "64"]
        for target, option in [("triangles", 0.1), ("triangles", 300), ("ratio", 0.25)]:
            with self.subTest(target=target, option=option):
                out, report = self.folder / "out.glb", self.folder / "out.json"
                run("simplify", self.file, "-o", out, f"--{target}", option, *few, "--report", report)
                level = self.oak.level(**{target: option}, views="6", resolution=64)
                self.assertEqual(level.to_bytes(), out.read_bytes())
                record = json.loads(report.read_text())
                for key in ["order_sha256", "areas_sha256", "leaves", "triangles", "vmi_bits"]:
                    self.assertEqual(level.report[key], record[key], key)
                self.assertEqual(level.triangle_count, record["triangles"]["final"])
                own = self.folder / "own.glb"
                self.assertEqual([os.fspath(p) for p in level.write(own)], [str(own)])
                self.assertEqual(own.read_bytes(), out.read_bytes())

    def test_levels_have_the_bytes_of_the_program(self):
        run("lods", self.file, "-o", self.folder / "lods", "--levels", "0.5,0.1")
        report = []
        levels = self.oak.levels(levels=[0.5, 0.1], progress=lambda *told: report.append(told))
        self.assertEqual(len(levels), 3)
        files = levels.to_bytes()
        self.assertEqual(sorted(files), ["oak_LOD0.glb", "oak_LOD1.glb", "oak_LOD2.glb"])
        for name, content in files.items():
            self.assertEqual(content, (self.folder / "lods" / name).read_bytes(), name)
        self.assertTrue(report and all(isinstance(stage, str) for stage, _, _ in report))
        self.assertEqual([level["kind"] for level in levels.report], ["original", "mesh", "mesh"])
        written = levels.write(self.folder / "one.glb")
        self.assertEqual(len(written), 1)
        self.assertIn("<html", levels.preview_html())

    def test_a_plant_that_was_grown_has_the_bytes_of_the_program(self):
        grown = secateur.grow("oak", leaves=240, seed=5)
        of_bytes = secateur.open(self.file.read_bytes(), name="oak.glb")
        level = [plant.level(ratio=0.5, views="6", resolution=64) for plant in (grown, of_bytes)]
        self.assertEqual(level[0].to_bytes(), level[1].to_bytes())
        self.assertEqual(grown.leaf_count, 240)
        self.assertTrue(grown.inspection["primitives"])

    def test_figures_are_those_of_measure(self):
        level = self.oak.level(ratio=0.25, views="6", resolution=64)
        file = self.folder / "quarter.glb"
        level.write(file)
        measured = json.loads(run("measure", self.file, file, "--format", "json"))
        judged = secateur.judge(self.oak, level)
        for key in ["difference", "block_coverage", "vmi_error_percent", "ssim", "differences", "rigs"]:
            self.assertEqual(judged[key], measured[key], key)
        with self.assertRaises(secateur.UsageError):
            secateur.judge(self.file, file, pixels_high=[1])

    def test_the_program_comes_along(self):
        ran = subprocess.run(
            [sys.executable, "-m", "secateur", "inspect", self.file, "--format", "json"],
            capture_output=True,
            text=True,
        )
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertEqual(json.loads(ran.stdout)["run"]["arguments"][0], "inspect")
        ran = subprocess.run([sys.executable, "-m", "secateur", "prune"], capture_output=True)
        self.assertEqual(ran.returncode, 2)


class Arrays(WithOak):
    def test_areas_sum_to_the_pixels_and_images_count_them(self):
        seen = self.oak.observe("6", 64, leaf_ids=True)
        self.assertEqual(seen.areas.shape, (6, 241))
        self.assertEqual(seen.areas.dtype, np.uint32)
        np.testing.assert_array_equal(seen.areas.sum(axis=1), 64 * 64)
        self.assertEqual(seen.leaf_ids.shape, (6, 64, 64))
        for view in range(6):
            counted = np.bincount(seen.leaf_ids[view].ravel(), minlength=241)
            np.testing.assert_array_equal(counted, seen.areas[view])
        self.assertEqual(hashlib.sha256(seen.areas.tobytes()).hexdigest(), seen.areas_sha256)

    def test_vmi_is_eq_2_of_the_areas(self):
        seen = self.oak.observe("6", 64)
        a = seen.areas.astype(float)
        total = a.sum(axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            bits = np.where(a > 0, a * np.log2(len(a) * a / total), 0).sum(axis=1) / 64**2
        np.testing.assert_allclose(seen.vmi_bits, bits, atol=1e-6)

    def test_a_level_is_seen_from_where_its_plant_was(self):
        level = self.oak.level(ratio=0.5, views="6", resolution=64, fit="none")
        self.assertEqual(len(level.removal_order), 120)
        self.assertEqual(len(set(level.removal_order.tolist())), 120)
        before, after = self.oak.observe("6", 64), level.observe("6", 64)
        np.testing.assert_array_equal(after.areas, level.areas)
        self.assertEqual(after.areas[:, level.removal_order].sum(), 0)
        error = before.vmi_error_percent(after)
        self.assertAlmostEqual(error, level.report["driving_vmi_error_percent"])
        self.assertEqual(level.leaf_arrays()["leaf_ids"].max(), 120)

    def test_arrays_make_the_plant_that_they_came_of(self):
        leaves = self.oak.leaf_arrays()
        again = secateur.from_arrays(leaves["positions"], leaves["triangles"], leaves["leaf_ids"])
        self.assertEqual(again.leaf_count, 240)
        solid = {"alpha": "ignore", "sides": "both"}
        np.testing.assert_array_equal(
            again.observe("6", 64, **solid).areas, self.oak.observe("6", 64, **solid).areas
        )
        masked = secateur.from_arrays(
            leaves["positions"],
            leaves["triangles"],
            leaves["leaf_ids"],
            uv=leaves["uv"],
            mask=np.zeros((4, 4), np.uint8),
        )
        self.assertEqual(masked.observe("6", 64, alpha="mask").areas[:, 1:].sum(), 0)

    def test_arrays_that_are_no_plant_are_refused(self):
        leaves = self.oak.leaf_arrays()
        p, t, ids = (leaves[name] for name in ["positions", "triangles", "leaf_ids"])
        far = t.copy()
        far[3, 1] = len(p)
        holed = p.copy()
        holed[5] = np.nan
        for arrays, says in [
            ((p[:, :2].copy(), t, ids), "(n, 3)"),
            ((p, far, ids), "triangles[3]"),
            ((holed, t, ids), "positions[5]"),
            ((p, t, ids[1:].copy()), "one for each"),
            ((p, t, np.zeros_like(ids)), "0 is wood"),
            ((p, t, np.ones_like(ids)), "leaf 1 is not one piece"),
        ]:
            with self.subTest(says=says), self.assertRaises(secateur.UsageError) as raised:
                secateur.from_arrays(*arrays)
            self.assertIn(says, str(raised.exception))


class Refusals(WithOak):
    def test_each_kind_of_failure_has_its_exception(self):
        with self.assertRaises(secateur.InputError) as raised:
            secateur.open(self.folder / "none.glb")
        self.assertIn("none.glb", str(raised.exception))
        with self.assertRaises(ValueError):
            secateur.open(b"no glTF")
        for options, says in [
            ({}, "--triangles"),
            ({"triangles": -1}, "-1"),
            ({"triangle": 0.1}, "--triangle"),
            ({"ratio": 0.5, "report": "r.json"}, "report"),
            ({"ratio": 0.5, "memory": "2G"}, "opened"),
        ]:
            with self.subTest(options=options), self.assertRaises(secateur.UsageError) as raised:
                self.oak.level(**options)
            self.assertIn(says, str(raised.exception))
        with self.assertRaises(secateur.MachineError):
            secateur.open(self.file, memory="1K")
        with self.assertRaises(secateur.UsageError):
            self.oak.levels(max_difference=9)

    def test_work_is_broken_off(self):
        event = threading.Event()
        event.set()
        with self.assertRaises(secateur.Cancelled):
            self.oak.levels(cancel=event)

        def refuse(stage, done, of):
            raise KeyError(stage)

        with self.assertRaises(KeyError):
            self.oak.level(ratio=0.5, views="6", resolution=64, progress=refuse)

    @unittest.skipIf(os.name == "nt", "signals of Unix")
    def test_ctrl_c_ends_a_call(self):
        def press(stage, done, of):
            os.kill(os.getpid(), signal.SIGINT)

        # What runs in the background is often started with the key ignored.
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        self.addCleanup(signal.signal, signal.SIGINT, before)
        with self.assertRaises(KeyboardInterrupt):
            self.oak.level(ratio=0.1, views="6", resolution=64, progress=press)

    def test_other_threads_go_on_meanwhile(self):
        def half():
            return self.oak.level(ratio=0.5, views="6", resolution=64)

        others = []
        thread = threading.Thread(target=lambda: others.append(half()))
        thread.start()
        ticks = 0
        while thread.is_alive():
            ticks += 1
        self.assertGreater(ticks, 10)
        self.assertEqual(others[0].leaf_count, 120)


if __name__ == "__main__":
    unittest.main()

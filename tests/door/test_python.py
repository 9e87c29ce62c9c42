"""The module `tangipaint`, as scientists use it."""
import gc
import json
import subprocess
import sys
import threading
import time
import warnings

import numpy as np
import pytest

from conftest import BUILD, SOURCE, run

import tangipaint as tp


def test_maps_look_into_the_painting(painting):
    p = tp.open(str(painting))
    assert p.height_mm.shape == (p.height, p.width) == (32, 48) and p.height_mm.dtype == np.float32
    assert p.normal.shape == (32, 48, 3)
    np.testing.assert_allclose(np.linalg.norm(p.normal, axis=2), 1, atol=1e-5)
    view = p.diffuse
    view[3, 4] = 0.25
    np.testing.assert_array_equal(p.diffuse[3, 4], 0.25)
    assert np.shares_memory(view, p.diffuse)
    p.height_mm = np.zeros((32, 48))
    assert not p.height_mm.any()
    del p
    gc.collect()
    assert view[3, 4, 0] == 0.25  # an array keeps its painting


def test_paintings_are_saved_and_read_again(painting, tmp_path):
    p = tp.open(str(painting))
    assert p.scale_known and p.mm_per_pixel == 0.25
    assert p.errors["height_mm"].shape == (32, 48) and (p.errors["slope"] > 0).any()
    p.save(str(tmp_path / "a.exr"))
    again = tp.open(str(tmp_path / "a.exr"))
    assert again.hash == p.hash
    np.testing.assert_array_equal(again.errors["slope"], p.errors["slope"])
    record = again.provenance
    assert record["program"].startswith("tangipaint ") and len(record["inputs"][0]["sha256"]) == 64


def test_fit_is_that_of_the_command(stack, painting):
    p, report = tp.fit(tp.Stack(str(stack)), mm_per_pixel=0.25)
    assert p.hash == tp.open(str(painting)).hash
    assert report["photographs"]["fitted"] == 12 and report["mm_per_pixel"] == 0.25


def test_relight_is_that_of_the_command_and_linear_in_the_lights(painting, tmp_path):
    p = tp.open(str(painting))
    run("relight", painting, "--light=-1,0.2,0.4", "--out", tmp_path / "a.exr")
    both = tp.relight(p, [(-1, 0.2, 0.4), tp.Light((0, 0, 1), gain=(0.5, 0.5, 0.5))])
    one = tp.relight(p, [(-1, 0.2, 0.4)])
    other = tp.relight(p, [(0, 0, 1)])
    np.testing.assert_allclose(both, one + 0.5 * other, atol=1e-6)
    tp.save_picture(str(tmp_path / "b.exr"), tp.relight(p, [(-1, 0.2, 0.4)], cast_shadows=True), "linear")
    difference = subprocess.run(["oiiotool", tmp_path / "a.exr", tmp_path / "b.exr", "--diff"], capture_output=True, text=True)
    assert "PASS" in difference.stdout, difference.stdout


def test_a_residual_stays_with_the_maps_that_it_was_fitted_beside(painting, tmp_path):
    p = tp.open(str(painting))
    assert p.has_residual
    light = [(-1, 0.2, 0.4)]
    relit = tp.relight(p, light, cast_shadows=True)
    bare = tp.relight(p, light, cast_shadows=True, residual=False)
    assert np.abs(relit - bare).max() > 1e-4
    np.testing.assert_array_equal(tp.relight(p, light), tp.relight(p, light, residual=False))
    with pytest.raises(tp.Error, match="cast_shadows"):
        tp.relight(p, light, residual=True)
    p.save(str(tmp_path / "again.exr"))
    np.testing.assert_array_equal(tp.relight(tp.open(str(tmp_path / "again.exr")), light, cast_shadows=True), relit)
    p.diffuse[:] *= 0.5
    assert not p.has_residual
    p.save(str(tmp_path / "changed.exr"))
    assert not tp.open(str(tmp_path / "changed.exr")).has_residual


def test_compare_is_that_of_the_command(stack, painting, tmp_path):
    held_out = stack / "heldout"
    told = tp.compare(tp.open(str(painting)), tp.Stack(str(held_out)))
    result, _ = run("compare", painting, held_out, "--out", tmp_path / "report")
    assert told["mean"]["held_out"]["psnr_db"] == pytest.approx(result["mean"]["held_out"]["psnr_db"], abs=1e-6)


def test_progress_is_told_and_may_stop_the_work(stack):
    stages = []
    tp.fit(tp.Stack(str(stack)), progress=lambda stage, part: stages.append((stage, part)), refine=False)
    assert len({stage for stage, _ in stages}) >= 2 and all(0 <= part <= 1 for _, part in stages)
    with pytest.raises(tp.Cancelled):
        tp.fit(tp.Stack(str(stack)), progress=lambda stage, part: False)

    def fails(stage, part):
        raise KeyError("of the callback")

    with pytest.raises(KeyError, match="of the callback"):
        tp.fit(tp.Stack(str(stack)), progress=fails)


def test_other_threads_of_python_run_meanwhile(stack):
    count = 0
    done = False

    def counts():
        nonlocal count
        while not done:
            count += 1
            time.sleep(0.001)

    thread = threading.Thread(target=counts)
    thread.start()
    began = time.monotonic()
    tp.fit(tp.Stack(str(stack)))
    seconds = time.monotonic() - began
    done = True
    thread.join()
    assert count > 20 * seconds


def test_what_goes_wrong_is_an_exception_of_its_kind(tmp_path, stack, painting):
    with pytest.raises(tp.Error, match="nowhere"):
        tp.Stack("nowhere")
    with pytest.raises(tp.Error, match="is not an EXR|no such file|cannot"):
        tp.open(str(tmp_path / "missing.exr"))
    with pytest.raises(TypeError, match="no option turbo"):
        tp.fit(tp.Stack(str(stack)), turbo=1)
    with pytest.raises(tp.Error, match="mm_per_pixel"):
        tp.fit(tp.Stack(str(stack)), mm_per_pixel=-1)
    p = tp.open(str(painting))
    with pytest.raises(tp.Error, match="height_mm.*2, 2.*32, 48"):
        p.height_mm = np.zeros((2, 2))
    with pytest.raises(tp.Error, match="direction"):
        tp.relight(p, [(0, 0, 0)])
    assert issubclass(tp.ContractError, AssertionError)


def test_poor_numbers_are_a_warning(tmp_path):
    folder = tmp_path / "photos"
    tp.generate(str(folder), width=64, height=64, lights=20, held_out=0, supersampling=1)
    lights = folder / "lights.lp"  # turned by half a turn
    lines = [line.split() for line in lights.read_text().splitlines()]
    lights.write_text("".join(" ".join([w[0], str(-float(w[1])), str(-float(w[2])), w[3]] if len(w) == 4 else w) + "\n" for w in lines))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        _, report = tp.fit(tp.Stack(str(folder)))
    assert report["poor"] and {str(w.message) for w in caught if w.category is tp.PoorNumbers} == set(report["poor"])


def test_paint_is_conserved_on_a_canvas(tmp_path):
    canvas = tp.Canvas.substrate("linen", width_mm=40, height_mm=30, pixel_mm=0.5)
    assert (canvas.width, canvas.height) == (80, 60) and "Titanium White" in tp.paints()
    canvas.stroke([(i / 30, -12 + i, 0, 0.6) for i in range(24)], {"Titanium White": 1}, {"preset": "flat", "size_mm": 6})
    laid = canvas.volumes_mm3["Titanium White"]
    assert laid > 0
    canvas.apply({"event": "dry", "layer": "first"})
    assert canvas.layers == ["first"] and canvas.volumes_mm3["Titanium White"] == pytest.approx(laid)
    canvas.save(str(tmp_path / "a.exr"))
    assert tp.Canvas.open(str(tmp_path / "a.exr")).layers == ["first"]
    painted, bare = canvas.painting(), tp.open(str(tmp_path / "a.exr"), painted=False)
    assert painted.height_mm.max() > bare.height_mm.max()
    with pytest.raises(tp.Error, match="palette|paint"):
        canvas.stroke([(0, 0, 0, 1)], {"No Such Paint": 1})


def test_lights_are_found_from_a_sphere(tmp_path):
    with pytest.raises(tp.Error, match="nowhere"):
        tp.calibrate(str(tmp_path / "nowhere"), str(tmp_path / "lights.lp"))


def test_stubs_say_what_the_module_has(tmp_path):
    ran = subprocess.run([sys.executable, "-m", "mypy.stubtest", "tangipaint", "--ignore-missing-stub"], capture_output=True, text=True,
                         env={"PYTHONPATH": str(BUILD / "python"), "PATH": "/usr/bin:/bin"}, cwd=tmp_path)
    wrong = [line for line in ran.stdout.splitlines() if line.startswith("error:") and "is not present at runtime" in line
             or "is not present in stub" in line]
    assert not wrong and "not checked stubs" not in ran.stdout, ran.stdout
    used = tmp_path / "use.py"
    used.write_text("import tangipaint\np, report = tangipaint.fit(tangipaint.Stack('photos'))\n"
                    "h: float = p.height_mm.max()\np.no_such_map\n")
    told = subprocess.run([sys.executable, "-m", "mypy", used], capture_output=True, text=True, cwd=tmp_path,
                          env={"MYPYPATH": str(BUILD / "python"), "PATH": "/usr/bin:/bin"})
    assert '"Painting" has no attribute "no_such_map"' in told.stdout and told.stdout.count("error:") == 1, told.stdout


def test_pip_installs_the_source_tree_without_network(tmp_path):
    target = tmp_path / "site"
    subprocess.run([sys.executable, "-m", "pip", "install", "--no-build-isolation", "--no-index", "--no-deps", "--target", target,
                    SOURCE], check=True, capture_output=True, env={"TANGIPAINT_BUILD": str(BUILD), "PATH": "/usr/bin:/bin",
                                                                   "HOME": str(tmp_path), "TMPDIR": str(tmp_path)})
    said = subprocess.run([sys.executable, "-c", "import tangipaint; print(tangipaint.__file__, tangipaint.__version__)"],
                          capture_output=True, text=True, cwd=tmp_path, env={"PYTHONPATH": str(target), "PATH": "/usr/bin"})
    assert str(target) in said.stdout and tp.__version__ in said.stdout, said.stderr


def test_the_notebook_runs(tmp_path):
    cells = json.loads((SOURCE / "docs/guide/python.ipynb").read_text())["cells"]
    code = [''.join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    assert 1 < sum(len(text.splitlines()) for text in code) <= 40
    (tmp_path / "cells.py").write_text("import matplotlib\nmatplotlib.use('Agg')\n" + "\n".join(code))
    ran = subprocess.run([sys.executable, "cells.py"], cwd=tmp_path, capture_output=True, text=True,
                         env={"PYTHONPATH": str(BUILD / "python"), "PATH": "/usr/bin:/bin", "HOME": str(tmp_path)})
    assert ran.returncode == 0, ran.stderr

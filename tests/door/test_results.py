"""What the commands say: results by their schema, events, logs, versions, inputs, and a fit repeated."""
import hashlib
import json
import re
import subprocess

import jsonschema
import pytest

from conftest import PROGRAM, SOURCE, run

SCHEMAS = SOURCE / "docs/reference/schemas"
VERSION = re.search(r"VERSION ([0-9.]+)", (SOURCE / "CMakeLists.txt").read_text().split("project(")[1]).group(1)


def schema(name):
    return json.loads((SCHEMAS / f"{name}.schema.json").read_text())


def require(value, name):
    jsonschema.Draft202012Validator(schema(name)).validate(value)


def results(stack, painting, tmp_path):
    """One result of each command that ends by itself."""
    out = tmp_path
    journal = SOURCE / "datasets/strokes/still_life.jsonl"
    strokes = out / "strokes.jsonl"
    lines = journal.read_text().splitlines()
    end = next(i for i, line in enumerate(lines) if '"end"' in line)
    strokes.write_text("\n".join(lines[:end + 1]) + "\n")
    yield ["generate", "--out", out / "g", "--width", 16, "--height", 16, "--lights", 4, "--held-out", 0, "--supersampling", 1]
    yield ["generate", "--out", out / "wall", "--positions", "2x1", "--overlap", 0.5, "--width", 240, "--height", 140, "--lights", 12,
           "--held-out", 0, "--supersampling", 1, "--no-whole-truth"]
    yield ["mosaic", out / "wall/r0_c0", out / "wall/r0_c1", "--out", out / "wall.exr"]
    yield ["fit", stack, "--out", out / "p.exr", "--residual"]
    yield ["compare", out / "p.exr", stack / "heldout", "--out", out / "report"]
    yield ["relight", painting, "--light=1,0,1", "--out", out / "a.png"]
    yield ["info", painting]
    yield ["info", stack / "lights.lp"]
    yield ["info", stack / "img_000.png"]
    for kind, name in (("maps", "maps"), ("ptm", "a.ptm"), ("rti", "a.rti"), ("web", "page"), ("openlime", "ol"), ("ora", "a.ora"),
                       ("layers", "layers"), ("snapshot", "s.png"), ("relight", "planes"), ("iiif", "iiif"), ("deepzoom", "dz"),
                       ("gltf", "a.glb"), ("stl", "a.stl"), ("ply", "a.ply"), ("obj", "a.obj")):
        yield ["export", painting, "--to", kind, "--out", out / name]
    yield ["info", out / "a.ptm"]
    yield ["import", out / "maps", "--out", out / "again.exr"]
    yield ["replay", "--substrate", "linen", "--width-mm", 60, "--height-mm", 40, "--pixel-mm", 1, strokes, "--out", out / "r.exr"]
    yield ["palette", "--out", out / "cards.png"]
    yield ["match", "--lab", "52,18,30"]
    t = out / "t"
    loss = ["--class", "loss_to_ground"]
    yield ["treatment", "begin", t, "--painting", painting]
    yield ["damage", painting, "--treatment", t, "--suggest", "loss"]
    yield ["damage", painting, "--treatment", t, *loss, "--polygon=-3,-2;-1,-2;-1,1;-3,1"]
    yield ["fill", t, *loss]
    yield ["varnish", t, "--isolating", *loss]
    yield ["retouch", "--treatment", t, *loss, "--mode", "neutral"]
    yield ["quality", "--treatment", t]
    yield ["treatment", "status", t]
    yield ["treatment", "check", t]
    yield ["treatment", "report", t, "--out", out / "t.pdf"]
    yield ["calibrate", stack, "--no-spheres", "--chart", "off", "--ppi", 300, "--out", out / "capture.json"]
    yield ["archive", painting, "--out", out / "bag"]
    yield ["archive", "--check", out / "bag"]


def test_every_result_has_the_form_that_its_schema_says(stack, painting, tmp_path):
    seen = set()
    for words in results(stack, painting, tmp_path):
        ran = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
        assert ran.returncode in (0, 3), (words, ran.stderr)
        result = json.loads(ran.stdout)
        require(result, "results")
        assert result["version"] == VERSION
        seen.add(result["command"])
    assert seen >= {"generate", "fit", "mosaic", "compare", "relight", "info", "export", "import", "replay", "palette", "match", "damage",
                    "fill", "varnish", "retouch", "quality", "treatment", "calibrate", "archive"}


def test_a_schema_refuses_what_is_not_of_its_form(stack, painting):
    result, _ = run("info", painting)
    for change in ({"command": "dance"}, {"seconds": "long"}, {"version": 2}):
        with pytest.raises(jsonschema.ValidationError):
            require({**result, **change}, "results")
    with pytest.raises(jsonschema.ValidationError):
        require({key: value for key, value in result.items() if key != "kind"}, "results")


def test_files_that_are_read_have_schemas(stack, painting, tmp_path):
    palette = tmp_path / "palette.json"
    run("palette", "--save", palette, "--out", tmp_path / "cards.png")
    require(json.loads(palette.read_text()), "palette")
    run("calibrate", stack, "--no-spheres", "--chart", "off", "--ppi", 300, "--out", tmp_path / "capture.json")
    require(json.loads((tmp_path / "capture.json").read_text()), "capture")
    for line in (SOURCE / "datasets/strokes/still_life.jsonl").read_text().splitlines():
        require(json.loads(line), "journal")
    run("damage", painting, "--treatment", tmp_path / "t", "--suggest", "loss")
    lines = (tmp_path / "t/log.jsonl").read_text().splitlines()
    assert len(lines) >= 2
    for line in lines:
        require(json.loads(line), "treatment-log")
    for name, wrong in (("palette", {"format": "tangipaint palette"}), ("journal", {"event": "dance"}), ("treatment-log", {})):
        with pytest.raises(jsonschema.ValidationError):
            require(wrong, name)


def test_events_are_json_one_a_line(stack, tmp_path):
    _, err = run("fit", stack, "--out", tmp_path / "a.exr", "--progress", "json")
    events = [json.loads(line) for line in err.splitlines()]
    for event in events:
        require(event, "events")
    stages = [event["stage"] for event in events if event["event"] == "progress"]
    assert len(set(stages)) >= 3 and events[-1]["event"] == "end" and events[-1]["exit_code"] == 0
    _, err = run("fit", "nowhere", "--out", tmp_path / "b.exr", "--progress", "json", code=1)
    last = json.loads(err.splitlines()[-1])
    assert last["event"] == "end" and last["exit_code"] == 1 and "nowhere" in last["text"]


def test_quiet_says_errors_alone(stack, tmp_path):
    result, err = run("fit", stack, "--out", tmp_path / "a.exr", "--quiet", "--lights", stack / "lights.lp")
    assert err == "" and result["warnings"] is not None
    _, err = run("info", tmp_path / "missing.exr", "--quiet", code=1)
    assert "missing.exr" in err


def test_a_log_holds_what_happened(painting, tmp_path):
    log = tmp_path / "log.jsonl"
    run("info", painting, "--log", log, "--quiet")
    run("info", tmp_path / "missing.exr", "--log", log, code=1)
    events = [json.loads(line) for line in log.read_text().splitlines()]
    for event in events:
        require(event, "events")
    assert [event["event"] for event in events if event["event"] != "stage"] == ["start", "end", "start", "end"]
    assert events[0]["arguments"][:2] == ["info", str(painting)] and events[0]["version"] == VERSION
    assert events[-1]["exit_code"] == 1 and "missing.exr" in events[-1]["text"]
    assert all(re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", event["time"]) for event in events)
    other = tmp_path / "photo.txt"
    other.write_text("not a log\n")
    _, err = run("info", painting, "--log", other, code=1)
    assert "--log" in err and other.read_text() == "not a log\n"


def test_results_name_their_inputs_by_hash(stack, painting, tmp_path):
    result, _ = run("relight", painting, "--light=1,0,1", "--out", tmp_path / "a.png")
    assert result["inputs"] == [{"file": "painting.exr", "bytes": painting.stat().st_size,
                                 "sha256": hashlib.sha256(painting.read_bytes()).hexdigest(),
                                 "modified": result["inputs"][0]["modified"]}]
    record, _ = run("info", painting)
    inputs = {entry["file"]: entry for entry in record["provenance"]["inputs"]}
    assert {"img_000.png", "lights.lp"} <= set(inputs)
    assert inputs["img_000.png"]["sha256"] == hashlib.sha256((stack / "img_000.png").read_bytes()).hexdigest()
    assert str(stack) not in json.dumps(record["provenance"]) and "/" not in inputs["lights.lp"]["file"]


def test_a_fit_is_repeated_like_another(stack, tmp_path):
    first, _ = run("fit", stack, "--out", tmp_path / "a.exr", "--mm-per-pixel", 0.5, "--no-refine", "--crop", "4,4,24,20",
                   "--max-iterations", 7, "--lights", stack / "lights.lp")
    again, _ = run("fit", stack, "--out", tmp_path / "b.exr", "--like", tmp_path / "a.exr")
    assert again["dry_hash"] == first["dry_hash"] and again["options"] == first["options"]
    changed, _ = run("fit", stack, "--out", tmp_path / "c.exr", "--like", tmp_path / "a.exr", "--mm-per-pixel", 0.25)
    assert changed["mm_per_pixel"] == 0.25 and changed["width"] == 24 and changed["refined"] is False
    plain, _ = run("fit", stack, "--out", tmp_path / "d.exr")
    assert plain["dry_hash"] != first["dry_hash"]
    _, err = run("fit", stack, "--out", tmp_path / "e.exr", "--like", stack / "gt/truth.exr", code=1)
    assert "--like" in err and "truth.exr" in err


def test_paintings_say_program_and_format(painting, tmp_path):
    said = subprocess.run(["oiiotool", "--info", "-v", painting], capture_output=True, text=True).stdout
    assert f'"tangipaint {VERSION}"' in said and "format_version: 2" in said
    assert subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout == f"tangipaint {VERSION}\n"
    newer = bytearray(painting.read_bytes())
    at = newer.index(b"format_version\0int\0") + len(b"format_version\0int\0") + 4
    newer[at] = 9
    (tmp_path / "newer.exr").write_bytes(newer)
    _, err = run("info", tmp_path / "newer.exr", code=1)
    assert "format version 9" in err and "newer version of the program" in err

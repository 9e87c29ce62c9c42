"""What is published, read by programs of others."""
import base64
import contextlib
import functools
import http.server
import json
import os
import re
import struct
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from conftest import BUILD, SOURCE, run

VALIDATORS = SOURCE / "build/validators/node_modules"


def exif(path):
    return json.loads(subprocess.run(["exiftool", "-j", "-G1", path], capture_output=True, text=True, check=True).stdout)[0]


@pytest.mark.parametrize("extension", ["jpg", "tif", "png", "exr"])
def test_pictures_say_what_they_are(painting, tmp_path, extension):
    out = tmp_path / f"a.{extension}"
    run("relight", painting, "--light=-1,0.2,0.4", "--out", out, "--title", "Still life <1>", "--creator", "A. Painter", "--credit", "Museum & Co")
    said = exif(out)
    text = json.dumps(said)
    if extension != "exr":  # exiftool shows no packet of an EXR file
        assert said["XMP-dc:Title"] == "Still life <1>" and said["XMP-dc:Creator"] == "A. Painter"
        assert said["XMP-photoshop:Credit"] == "Museum & Co" and re.fullmatch("sha256:[0-9a-f]{64}", said["XMP-dc:Source"])
        assert said["XMP-xmp:CreatorTool"].startswith("tangipaint 0.2")
    if extension == "jpg":
        assert said["IPTC:ObjectName"] == "Still life <1>" and said["IPTC:Credit"] == "Museum & Co"
    assert "A. Painter" in text and "Relit by a light from -0.9" in text and "model bounded" in text and "tangipaint 0.2" in text
    per_inch = {"jpg": "JFIF:XResolution", "tif": "IFD0:XResolution", "exr": "OpenEXR:XResolution"}
    if extension == "png":
        assert said["PNG-pHYs:PixelsPerUnitX"] == 4000  # a metre
    else:
        assert float(said[per_inch[extension]]) == pytest.approx(25.4 / 0.25, rel=1e-2)
    warned = subprocess.run(["exiftool", "-validate", "-warning", "-a", out], capture_output=True, text=True).stdout
    assert "Error" not in warned, warned


def test_a_picture_of_the_snapshot_is_the_same_with_and_without_notes(painting, tmp_path):
    run("export", painting, "--to", "snapshot", "--out", tmp_path / "a.tif", "--title", "One")
    run("export", painting, "--to", "snapshot", "--out", tmp_path / "b.tif", "--title", "Another, longer one")
    assert "PASS" in subprocess.run(["oiiotool", tmp_path / "a.tif", tmp_path / "b.tif", "--diff"], capture_output=True, text=True).stdout


def faces_of_stl(path):
    data = path.read_bytes()
    count = struct.unpack("<I", data[80:84])[0]
    assert len(data) == 84 + 50 * count
    return np.frombuffer(data[84:], dtype=np.dtype([("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")]))


def test_a_mesh_is_closed_and_of_the_size_that_was_asked_for(painting, tmp_path):
    result, _ = run("export", painting, "--to", "stl", "--out", tmp_path / "a.stl", "--triangles", 1500, "--base-mm", 3)
    assert 1000 < result["triangles"] <= 1500 and result["closed"] and result["unit"] == "mm"
    said = subprocess.run(["admesh", tmp_path / "a.stl"], capture_output=True, text=True).stdout
    number = lambda name: int(re.search(name + r"\s*:?\s*(\d+)", said).group(1))
    assert number("Total disconnected facets") == 0 and number("Number of parts") == 1, said
    assert number("Backwards edges") == 0 and number("Normals fixed") == 0, said
    faces = faces_of_stl(tmp_path / "a.stl")
    size = np.ptp(faces["v"].reshape(-1, 3), axis=0)
    assert size[0] == pytest.approx(47 * 0.25) and size[1] == pytest.approx(31 * 0.25) and 3 <= size[2] < 10
    # The volume of a closed mesh, whose faces look outwards.
    a, b, c = faces["v"][:, 0].astype(float), faces["v"][:, 1].astype(float), faces["v"][:, 2].astype(float)
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6 > 0.9 * 3 * size[0] * size[1]


def test_meshes_of_all_kinds_are_the_same(painting, tmp_path):
    for kind in ("stl", "ply", "obj"):
        run("export", painting, "--to", kind, "--out", tmp_path / f"a.{kind}", "--triangles", 500, "--base-mm", 0)
    stl = faces_of_stl(tmp_path / "a.stl")["v"]
    lines = [line.split() for line in (tmp_path / "a.obj").read_text().splitlines()]
    vertices = np.array([[float(x) for x in line[1:4]] for line in lines if line[0] == "v"])
    triangles = np.array([[int(i) - 1 for i in line[1:]] for line in lines if line[0] == "f"])
    np.testing.assert_allclose(vertices[triangles], stl, atol=1e-4)
    data = (tmp_path / "a.ply").read_bytes()
    head, body = data.split(b"end_header\n", 1)
    count = int(re.search(rb"element vertex (\d+)", head).group(1))
    ply = np.frombuffer(body[:15 * count], dtype=np.dtype([("v", "<f4", 3), ("c", "u1", 3)]))
    np.testing.assert_allclose(ply["v"], vertices, atol=1e-4)
    assert ply["c"].max() > 60


@pytest.mark.parametrize("relief", [[], ["--relief", "--triangles", 800]])
def test_gltf_is_valid(painting, tmp_path, relief):
    out = tmp_path / "a.glb"
    run("export", painting, "--to", "gltf", "--out", out, *relief)
    data = out.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    document = json.loads(data[20:20 + length])
    material = document["materials"][0]
    assert "KHR_materials_specular" in material["extensions"] and ("normalTexture" in material) == (not relief)
    bounds = document["accessors"][document["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    assert bounds["max"][0] == pytest.approx(48 * 0.25 / 2000, rel=0.05)
    if not (VALIDATORS / "gltf-validator").is_dir():
        pytest.skip("gltf-validator is not there: script/bootstrap --validators")
    said = subprocess.run(["node", "-e", "const v = require('gltf-validator'); const fs = require('fs');"
                           "v.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1]))).then(r => console.log(JSON.stringify(r)))",
                           out], capture_output=True, text=True, env={**os.environ, "NODE_PATH": str(VALIDATORS)})
    report = json.loads(said.stdout)
    assert report["issues"]["numErrors"] == 0 and report["issues"]["numWarnings"] == 0, report["issues"]


VIEW = {"type": "urn:tangipaint:View", "value": "azimuth=20&elevation=30&look=0&x=20&y=10&zoom=2"}


@pytest.fixture
def notes(tmp_path):
    """Annotations of four kinds, in one file."""
    def note(text, selector, **more):
        return {"type": "Annotation", "motivation": "commenting", "body": {"type": "TextualBody", "value": text},
                "target": {"source": "elsewhere", "selector": selector, **more}}
    path = tmp_path / "notes.json"
    path.write_text(json.dumps({"@context": "http://www.w3.org/ns/anno.jsonld", "type": "AnnotationPage", "items": [
        note("A loss </script><b>", {"type": "SvgSelector", "value": "<svg xmlns='http://www.w3.org/2000/svg'><path d='M1 1L9 1L9 9Z'/></svg>"}, state=VIEW),
        note("A crack", {"type": "FragmentSelector", "value": "xywh=10,12,20,5"}),
        note("A pin", {"type": "PointSelector", "x": 30, "y": 20}),
        {**note("A corner", {}), "target": "http://elsewhere.example/picture#xywh=0,0,8,8"}]}))
    return path


def test_iiif_has_a_manifest_and_all_tiles_that_it_promises(painting, tmp_path, notes):
    out = tmp_path / "iiif"
    url = "https://museum.example/1"
    run("export", painting, "--to", "iiif", "--out", out, "--url", url, "--title", "Painting", "--credit", "CC0", "--annotations", notes)
    manifest = json.loads((out / "manifest.json").read_text())
    assert manifest["id"] == url + "/manifest.json" and manifest["label"] == {"none": ["Painting"]}
    canvas = manifest["items"][0]
    assert (canvas["width"], canvas["height"]) == (48, 32)
    choice = canvas["items"][0]["items"][0]["body"]
    assert choice["type"] == "Choice" and len(choice["items"]) == 7
    noted = canvas["annotations"][0]["items"]
    assert len(noted) == 4 and all(n["target"]["source"]["id"] == canvas["id"] for n in noted)
    assert noted[0]["target"]["selector"]["type"] == "SvgSelector" and noted[0]["target"]["state"] == VIEW
    assert noted[3]["target"]["selector"] == {"type": "FragmentSelector", "value": "xywh=0,0,8,8"}
    for body in choice["items"]:
        assert (out / body["id"][len(url) + 1:]).is_file(), body["id"]
        check_image(out / body["service"][0]["id"][len(url) + 1:])
    if not (VALIDATORS / "@iiif/parser").is_dir():
        pytest.skip("@iiif/parser is not there: script/bootstrap --validators")
    read = ("import {presentation3StrictUpgrade} from '@iiif/parser/strict'; import {normalize} from '@iiif/parser/presentation-3';"
            "import fs from 'fs'; const text = fs.readFileSync(process.argv[1], 'utf8'), state = {warnings: []};"
            "presentation3StrictUpgrade(JSON.parse(text), state); const found = normalize(JSON.parse(text)).entities;"
            "console.log(JSON.stringify([state.warnings, Object.keys(found.Canvas).length, Object.keys(found.Annotation).length]))")
    said = subprocess.run(["node", "--input-type=module", "-e", read, out / "manifest.json"], capture_output=True, text=True,
                          cwd=VALIDATORS.parent)
    assert json.loads(said.stdout) == [[], 1, 5], said.stdout + said.stderr


def check_image(folder):
    """Every tile that a viewer asks for by the Image API 3 is a file, of the size that its address says."""
    info = json.loads((folder / "info.json").read_text())
    assert info["type"] == "ImageService3" and info["profile"] == "level0"
    asked = set()
    for size in info["sizes"]:
        asked.add(("full", size["width"], size["height"]))
    tile = info["tiles"][0]
    for factor in tile["scaleFactors"]:
        side = tile["width"] * factor
        for y in range(0, info["height"], side):
            for x in range(0, info["width"], side):
                w, h = min(side, info["width"] - x), min(side, info["height"] - y)
                region = "full" if (w, h) == (info["width"], info["height"]) else f"{x},{y},{w},{h}"
                asked.add((region, -(-w // factor), -(-h // factor)))
    for region, w, h in asked:
        file = folder / region / f"{w},{h}/0/default.jpg"
        assert file.is_file(), file
        assert subprocess.run(["oiiotool", "--info", file], capture_output=True, text=True).stdout.split(":")[1].split(",")[0].split() == [str(w), "x", str(h)]
    there = {str(f.relative_to(folder)) for f in folder.rglob("default.jpg")}
    assert there == {f"{region}/{w},{h}/0/default.jpg" for region, w, h in asked}


def test_large_pictures_have_tiles_at_their_borders(tmp_path):
    """1100 x 700 pixels: several tiles of 512, none of which divides it."""
    sys.path.insert(0, str(BUILD / "python"))
    import tangipaint

    p = tangipaint.Painting(1100, 700)
    p.diffuse = np.random.default_rng(1).random((700, 1100, 3), dtype=np.float32)
    p.confidence = np.ones((700, 1100))
    p.roughness = np.full((700, 1100), 0.2)
    p.save(str(tmp_path / "p.exr"))
    run("export", tmp_path / "p.exr", "--to", "iiif", "--out", tmp_path / "iiif", "--url", "http://a.example")
    check_image(tmp_path / "iiif/picture")
    run("export", tmp_path / "p.exr", "--to", "deepzoom", "--out", tmp_path / "dz")
    levels = sorted(int(f.name) for f in (tmp_path / "dz/picture_files").iterdir())
    assert levels == list(range(12))  # 2^11 >= 1100
    assert sorted(f.name for f in (tmp_path / "dz/picture_files/11").iterdir()) == ["0_0.jpg", "0_1.jpg", "1_0.jpg", "1_1.jpg", "2_0.jpg", "2_1.jpg"]


CHROMIUM = ["chromium-headless-shell", "--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
OPENLIME = os.environ.get("TP_OPENLIME")  # a checkout of its sources, 1.2.6


def test_the_page_for_openlime_draws_the_painting(painting, tmp_path, notes):
    out = tmp_path / "lime"
    run("export", painting, "--to", "openlime", "--out", out, "--annotations", notes)
    page = (out / "index.html").read_text()
    layer = json.loads(re.search(r"new OpenLIME.Layer\((.*)\);", page).group(1))
    brdf = json.loads((out / "brdf.json").read_text())
    assert layer["channels"] == brdf["channels"] and layer["alphaLimits"] == brdf["alphaLimits"]
    assert "OpenLIME 1.2.6" in page
    shown = json.loads(re.search(r"const annotations = (\[.*\])\.map", page).group(1))
    assert [n["label"] for n in shown] == ["A loss &lt;/script&gt;&lt;b&gt;", "A crack", "A pin", "A corner"]
    assert '<rect x="10" y="12" width="20" height="5"/>' in shown[1]["svg"] and '<circle cx="30" cy="20"' in shown[2]["svg"]
    assert shown[0]["data"]["light"] == pytest.approx([0.8138, 0.2962], abs=1e-4) and "light" not in shown[1]["data"]
    if not OPENLIME:
        pytest.skip("TP_OPENLIME names no sources of OpenLIME")
    # As a web server would hand it out, with the sources in the place of what is made of them.
    (out / "src").mkdir()
    for source in Path(OPENLIME, "src").glob("*.js"):  # with whole names in imports, which bundlers complete
        text = re.sub(r"""(from|import) (['"])(\./\w+)\2""", r"\1 \2\3.js\2", source.read_text())
        (out / "src" / source.name).write_text(text)
    assert json.loads(Path(OPENLIME, "package.json").read_text())["version"] == "1.2.6"
    parts = sorted(set(re.findall(r"'\./(src/\w+\.js)'", Path(OPENLIME, "rollup.config.js").read_text())))
    (out / "openlime.esm.js").write_text("".join(f"export * from './{part}';\n" for part in parts))
    with served(out) as address:
        told = subprocess.run([*CHROMIUM, "--virtual-time-budget=8000", "--window-size=480,320", "--enable-logging=stderr", f"--screenshot={tmp_path / 'page.png'}", address],
                              capture_output=True, text=True, timeout=60)
    assert "Uncaught" not in told.stderr, told.stderr
    with served(out) as address:
        drawn = subprocess.run([*CHROMIUM, "--virtual-time-budget=8000", "--dump-dom", address], capture_output=True, text=True, timeout=60).stdout
    assert 'data-state="ready"' in drawn and drawn.count("<li><button>") == 4
    # The painting fills the window; it is drawn like the picture of the same light, as far as two renderers agree.
    run("export", painting, "--to", "snapshot", "--out", tmp_path / "a.png", "--light=-0.5,0.5,0.7")
    drawn, ours = (np.asarray(Image.open(tmp_path / name).convert("RGB").resize((48, 32), Image.BOX)).astype(float).mean(axis=2)
                   for name in ("page.png", "a.png"))
    assert np.corrcoef(drawn[4:-4, 4:-4].ravel(), ours[4:-4, 4:-4].ravel())[0, 1] > 0.7


def test_the_page_for_openlime_has_tiles_of_large_pictures(tmp_path):
    import tangipaint

    p = tangipaint.Painting(2100, 30)
    p.confidence = np.ones((30, 2100))
    p.roughness = np.full((30, 2100), 0.2)
    p.save(str(tmp_path / "p.exr"))
    run("export", tmp_path / "p.exr", "--to", "openlime", "--out", tmp_path / "lime")
    layer = json.loads(re.search(r"new OpenLIME.Layer\((.*)\);", (tmp_path / "lime/index.html").read_text()).group(1))
    assert layer["layout"] == "deepzoom" and set(layer["channels"]) == {"kd", "ks", "normals", "gloss"}
    for name, dzi in layer["channels"].items():
        assert (tmp_path / "lime" / dzi).is_file()
        format = "jpg" if name in ("kd", "ks") else "png"
        assert (tmp_path / f"lime/tiles/{name}_files/12/4_0.{format}").is_file()
    run("import", tmp_path / "lime", "--out", tmp_path / "again.exr")


@contextlib.contextmanager
def served(folder):
    class Handler(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/index.html"
    finally:
        server.shutdown()


@pytest.mark.parametrize("kind", ["tif", "png"])
def test_maps_are_written_in_whole_numbers_with_their_scale(painting, tmp_path, kind):
    import tangipaint

    run("export", painting, "--to", "maps", "--out", tmp_path / "m", "--maps-format", kind, "--creator", "A. Painter")
    about = json.loads((tmp_path / "m/maps.json").read_text())
    p = tangipaint.open(str(painting))
    values = np.asarray(Image.open(tmp_path / f"m/height.{kind}")).astype(float) / 65535
    height = about["maps"]["height"]
    restored = height["from"] + values * (height["to"] - height["from"])
    np.testing.assert_allclose(restored, p.height_mm, atol=(height["to"] - height["from"]) / 60000)
    said = exif(tmp_path / f"m/height.{kind}")
    assert said["XMP-dc:Creator"] == "A. Painter"
    assert list((tmp_path / "m").glob(f"height_error_full_scale_*.{kind}"))


@pytest.mark.parametrize("kind,name", [("ptm", "a.ptm"), ("rti", "a.rti"), ("relight", "planes")])
def test_rti_files_are_imported_with_their_doubts(painting, tmp_path, kind, name):
    import tangipaint

    run("export", painting, "--to", kind, "--out", tmp_path / name)
    result, err = run("import", tmp_path / name, "--out", tmp_path / "again.exr", "--mm-per-pixel", 0.25, code=3)
    assert "highlights are smoothed" in result["poor"][0] and len(result["inputs"]) >= 1
    first, again = tangipaint.open(str(painting)), tangipaint.open(str(tmp_path / "again.exr"))
    cosine = np.clip((first.normal * again.normal).sum(axis=2), -1, 1)
    assert np.degrees(np.arccos(cosine)).mean() < 6
    light = [(0.4, 0.3, 0.8)]
    a, b = (np.clip(tangipaint.relight(p, light), 0, 1) ** (1 / 2.2) for p in (first, again))
    gain = (a * b).sum() / (b * b).sum()
    assert 10 * np.log10(1 / np.mean((a - gain * b) ** 2)) > 22
    assert again.provenance["command"] == "import"


def test_relight_folders_that_are_wrong_are_named(painting, tmp_path):
    run("export", painting, "--to", "relight", "--out", tmp_path / "planes")
    info = json.loads((tmp_path / "planes/info.json").read_text())
    assert info["type"] == "ptm" and info["nplanes"] == 18 and len(info["materials"][0]["scale"]) == 18
    (tmp_path / "planes/plane_3.jpg").unlink()
    _, err = run("import", tmp_path / "planes", "--out", tmp_path / "a.exr", code=1)
    assert "plane_3.jpg" in err
    info["type"] = "rbf"
    (tmp_path / "planes/info.json").write_text(json.dumps(info))
    _, err = run("import", tmp_path / "planes", "--out", tmp_path / "a.exr", code=1)
    assert "type rbf" in err and "info.json" in err


def test_a_bag_is_one_for_others_and_its_faults_are_found(stack, painting, tmp_path):
    bag = tmp_path / "bag"
    result, _ = run("archive", stack, painting, "--out", bag, "--title", "A painting", "--organization", "Museum")
    assert (bag / "bagit.txt").read_text() == "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n"
    for manifest in ("manifest-sha256.txt", "tagmanifest-sha256.txt"):
        subprocess.run(["sha256sum", "--check", "--strict", "--quiet", manifest], cwd=bag, check=True)
    payload = [f for f in (bag / "data").rglob("*") if f.is_file()]
    listed = {line.split("  ", 1)[1] for line in (bag / "manifest-sha256.txt").read_text().splitlines()}
    assert listed == {str(f.relative_to(bag)) for f in payload} and result["payload_files"] == len(payload)
    about = (bag / "bag-info.txt").read_text()
    assert f"Payload-Oxum: {sum(f.stat().st_size for f in payload)}.{len(payload)}\n" in about and "Source-Organization: Museum" in about
    assert run("archive", "--check", bag)[0]["checked"] is True

    changed = bag / "data/painting.exr"
    data = bytearray(changed.read_bytes())
    data[-1] ^= 1
    changed.write_bytes(data)
    (bag / "data/photos/lights.lp").unlink()
    (bag / "data/more.txt").write_text("more")
    _, err = run("archive", "--check", bag, code=1)
    for fault in ("data/painting.exr: has changed", "data/photos/lights.lp: is missing", "data/more.txt: is in no manifest"):
        assert fault in err, err
    _, err = run("archive", painting, "--out", bag, code=1)
    assert "is there already" in err
    _, err = run("archive", stack, "--out", stack / "bag", code=1)
    assert "lies in" in err and not (stack / "bag").exists()


def told_in_head(page, kind):
    text = page.read_text()
    return json.loads(re.search(rf'<script type="{kind}"[^>]*>(.*?)</script>', text, re.S).group(1))


def test_the_web_page_says_what_it_is_of_and_holds_annotations(painting, tmp_path, notes):
    run("export", painting, "--to", "web", "--out", tmp_path / "page", "--title", "Still life <1>", "--creator", "A. Painter", "--credit", "Museum",
        "--annotations", notes)
    work = told_in_head(tmp_path / "page/index.html", r"application/ld\+json")
    assert work["@context"] == "https://schema.org" and work["@type"] == "VisualArtwork"
    assert work["name"] == "Still life <1>" and work["creator"]["name"] == "A. Painter" and work["creditText"] == "Museum"
    assert work["width"] == {"@type": "QuantitativeValue", "value": 12, "unitCode": "MMT"}
    made = work["encoding"]["isBasedOn"]
    assert made["name"] == "painting.exr" and re.fullmatch("[0-9a-f]{64}", made["sha256"])
    assert len(made["isBasedOn"]) >= 12 and all(re.fullmatch("[0-9a-f]{64}", photo["sha256"]) for photo in made["isBasedOn"])
    data = told_in_head(tmp_path / "page/index.html", "application/json")
    assert data["id"] == "urn:tangipaint:" + made["sha256"] and len(data["annotations"]) == 4
    assert len({n["id"] for n in data["annotations"]}) == 4


@pytest.mark.parametrize("content, said", [
    ("{", "not JSON"), ("{}", "no AnnotationPage"), ('[{"type": "Annotation"}]', "item 1 is no Annotation with a target"),
    ('[{"type": "Annotation", "target": "http://a.example/picture"}]', "item 1: its target is a whole resource"),
    ('[{"type": "Annotation", "target": {"selector": {"type": "SvgSelector", "value": "<svg><path d=\'M0 0\'></svg>"}}}]', "item 1: its SvgSelector closes </svg>, which is not open"),
    ('[{"type": "Annotation", "target": {"selector": {"type": "SvgSelector", "value": "<svg></svg>"}}}]', "item 1: its SvgSelector has no shape"),
    ('[{"type": "Annotation", "target": {"selector": {"type": "CssSelector", "value": "p"}}}]', "item 1: its selector is CssSelector"),
    ('[{"type": "Annotation", "target": {"selector": []}}]', "item 1: its target has an empty list"), ("[3]", "item 1 is no Annotation")])
@pytest.mark.parametrize("to", ["web", "iiif", "openlime"])
def test_bad_annotations_are_refused_before_anything_is_written(painting, tmp_path, to, content, said):
    (tmp_path / "bad.json").write_text(content)
    _, told = run("export", painting, "--to", to, "--out", tmp_path / "out", "--annotations", tmp_path / "bad.json", code=1)
    assert "bad.json" in told and said in told, told
    assert not (tmp_path / "out").exists()


def test_states_of_a_page_are_earlier_paintings_or_layers(painting, tmp_path):
    import tangipaint

    result, _ = run("export", painting, "--to", "web", "--out", tmp_path / "page", "--state", f"Before={painting}")
    assert result["states"] == ["Before", "painting"] and result["shared_tiles"] == result["tiles"] == 1
    small = tangipaint.Painting(20, 30)
    small.confidence = np.ones((30, 20))
    small.roughness = np.full((30, 20), 0.2)
    small.save(str(tmp_path / "small.exr"))
    _, told = run("export", painting, "--to", "web", "--out", tmp_path / "out", "--state", tmp_path / "small.exr", code=1)
    assert "has 20 × 30 pixels" in told and "--align-to" in told
    _, told = run("export", painting, "--to", "web", "--out", tmp_path / "out", "--layers", code=1)
    assert "has no layers of paint" in told
    journal = tmp_path / "a.jsonl"
    journal.write_text('{"format": "tangipaint strokes", "version": 1}\n'
                       '{"event": "pile", "on": "painting", "paint": {"Bone Black": 1}, "x": 0, "y": 0, "size_mm": 4}\n'
                       '{"event": "dry", "layer": "retouch"}\n')
    run("replay", painting, journal, "--out", tmp_path / "painted.exr")
    result, _ = run("export", tmp_path / "painted.exr", "--to", "web", "--out", tmp_path / "layers", "--layers")
    assert result["states"] == ["Without paint", "retouch"] and (tmp_path / "layers/parts/state1/0/0_0.js").is_file()
    for origin in ("museum.example", "https://museum.example/page", "ftp://a.example"):
        _, told = run("export", painting, "--to", "web", "--out", tmp_path / "out", "--embed-origin", origin, code=2)
        assert "--embed-origin" in told
    assert not (tmp_path / "out").exists()


HOST = """<iframe src="{page}" style="width:600px;height:500px"></iframe><pre id="told"></pre><script>
const frame = document.querySelector('iframe'), told = [];
addEventListener('message', async ({{data}}) => {{
  told.push(data.png ? {{...data, png: btoa(String.fromCharCode(...new Uint8Array(await data.png.arrayBuffer())))}} : data);
  document.getElementById('told').textContent = JSON.stringify(told);
}});
const asks = [{{tangipaint: 'listen', id: 0}}, {{tangipaint: 'set', id: 1, light: {{azimuth: 20, elevation: 500, colour: '#ff8040'}}, look: 'Height'}},
  {{tangipaint: 'set', id: 2, light: {{azimuth: 'left'}}}}, {{tangipaint: 'get', id: 3}}, {{tangipaint: 'annotations', id: 4}}, {{tangipaint: 'snapshot', id: 5}},
  {{tangipaint: 'set', id: 6, annotation: 'urn:tangipaint:annotation:1'}}, {{tangipaint: 'eject', id: 7}}];
asks.forEach((ask, i) => setTimeout(() => frame.contentWindow.postMessage(ask, '*'), 3000 + 500 * i));
</script>"""


@pytest.mark.parametrize("trusted", [True, False])
def test_the_page_hears_sites_that_it_was_exported_for(painting, tmp_path, notes, trusted):
    (tmp_path / "host").mkdir()
    with served(tmp_path / "host") as host, served(tmp_path / "page") as page:
        origin = host.removesuffix("/index.html") if trusted else "https://museum.example"
        run("export", painting, "--to", "web", "--out", tmp_path / "page", "--embed-origin", origin, "--annotations", notes,
            "--title", "Füße", "--creator", "A. Painter", "--credit", "© Museum")
        (tmp_path / "host/index.html").write_text(HOST.format(page=page))
        drawn = subprocess.run([*CHROMIUM, "--virtual-time-budget=20000", "--disable-features=IsolateOrigins,site-per-process", "--dump-dom", host],
                               capture_output=True, text=True, timeout=100).stdout
    text = re.search(r'<pre id="told">(.*?)</pre>', drawn, re.S).group(1)
    if not trusted:
        assert text == ""
        return
    told = json.loads(text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))
    assert told[0]["tangipaint"] == "ready"
    answers = {one["id"]: one for one in told if "id" in one}
    assert answers[1]["light"] == {"azimuth": 20, "elevation": 90, "colour": "#ff8040", "softness": 1.5} and answers[1]["look"] == "Height"
    assert answers[2]["tangipaint"] == "error" and answers[2]["message"] == 'azimuth "left" is no number'
    assert answers[3]["light"] == answers[1]["light"] and answers[3]["picture"]["mm_per_pixel"] == 0.25
    assert len(answers[4]["annotations"]["items"]) == 4
    (tmp_path / "snapshot.png").write_bytes(base64.b64decode(answers[5]["png"]))
    words = Image.open(tmp_path / "snapshot.png").text
    assert [words[key] for key in ("Title", "Author", "Copyright", "Description")] == \
        ["Füße", "A. Painter", "© Museum", "Height, lit from 20°, 90° high"]
    assert words["Software"].startswith("tangipaint ") and words["Source"].startswith("urn:tangipaint:")
    assert exif(tmp_path / "snapshot.png")["PNG:Copyright"] == "© Museum"
    assert answers[6]["annotation"] == "urn:tangipaint:annotation:1" and answers[6]["light"]["azimuth"] == 20 and answers[6]["light"]["elevation"] == 30
    assert answers[7]["tangipaint"] == "error" and "eject" in answers[7]["message"]
    assert {"changed", "selected"} <= {one["tangipaint"] for one in told}


def test_a_page_with_losses_is_small_and_says_how_well_it_relights(painting, tmp_path):
    whole, _ = run("export", painting, "--to", "web", "--out", tmp_path / "whole")
    result, _ = run("export", painting, "--to", "web", "--out", tmp_path / "lossy", "--lossy-psnr-db", 30)
    assert 30 <= result["psnr_db"] < 45 and 1 <= result["jpeg_quality"] <= 98 and 0 < result["height_rms"] < 0.1
    assert "psnr_db" not in whole
    parts = {name: sum(f.stat().st_size for f in (tmp_path / name / "parts").rglob("*.js")) for name in ("whole", "lossy")}
    assert parts["lossy"] < parts["whole"] / 2  # of 48 x 32 pixels, where the headers of a picture are half of it
    assert result["bytes"] == parts["lossy"] + (tmp_path / "lossy/index.html").stat().st_size
    result, told = run("export", painting, "--to", "web", "--out", tmp_path / "lossy", "--lossy-psnr-db", 60)
    assert "not the 60 of --lossy-psnr-db" in told and result["psnr_db"] < 60
    _, told = run("export", painting, "--to", "iiif", "--out", tmp_path / "iiif", "--lossy-psnr-db", 40, code=2)
    assert "--lossy-psnr-db" in told

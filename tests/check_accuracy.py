#!/usr/bin/env python3
"""Runs `talbot accuracy` as a user does and checks what it writes. Usage: check_accuracy.py TALBOT SOURCE_DIR"""
import csv
import html.parser
import json
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile

failures = []


def check(condition, what):
    if not condition:
        failures.append(what)
        print("FAILED", what)


def run(*words, code=0):
    done = subprocess.run([*words], capture_output=True, text=True, timeout=200)
    check(done.returncode == code, f"{words[1:]}: exit code {done.returncode}: {done.stdout[-600:]}{done.stderr[-600:]}")
    return done


class Page(html.parser.HTMLParser):
    """Collects elements by id, and everything that would make a request."""

    def __init__(self):
        super().__init__()
        self.ids, self.scripts, self.requests, self.open, self.stack = {}, {}, [], None, []

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag not in ("meta", "img", "input", "br"):
            self.stack.append(tag)
        if "id" in attributes:
            self.ids[attributes["id"]] = tag
        for name in ("src", "href", "action"):
            if attributes.get(name):
                self.requests.append(attributes[name])
        if tag == "script":
            self.open = attributes.get("id", "code")
            self.scripts[self.open] = ""

    def handle_endtag(self, tag):
        check(self.stack and self.stack[-1] == tag, f"HTML: </{tag}> closes {self.stack[-1:]}")
        if self.stack:
            self.stack.pop()
        if tag == "script":
            self.open = None

    def handle_data(self, data):
        if self.open:
            self.scripts[self.open] += data


def check_html(text, report):
    page = Page()
    page.feed(text)
    check(not page.stack, f"HTML: not closed: {page.stack}")
    check(not page.requests, f"HTML: would load {page.requests}")
    check("http" not in text.replace("http://www.w3.org/2000/svg", ""), "HTML: names an address")
    for name in ("table", "curves", "tip", "left", "right", "a", "b", "range", "command", "copy"):
        check(name in page.ids, f"HTML: no element {name}")
    used = set(re.findall(r"getElementById\('(\w+)'\)", page.scripts["code"]))
    check(used <= set(page.ids), f"HTML: the script asks for {used - set(page.ids)}")
    embedded = json.loads(page.scripts["data"])
    check(embedded["results"] == report["results"], "HTML: its figures are not those of the JSON")
    pictures = json.loads(page.scripts["pictures"])
    check(len(pictures["colors"]) == len(report["results"]), "HTML: a colour for every curve")
    check(len(pictures["images"]) == len(report["results"]) + 2, "HTML: pictures, first sample and error map")
    check(all(p["url"].startswith("data:image/png;base64,iVBORw0KGgo") for p in pictures["images"]), "HTML: pictures are PNG")


def browser_tools():
    """Chromium, node and the folder whose node_modules has playwright-core; None where one of them is missing."""
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    node = shutil.which("node")
    places = [os.environ.get("TALBOT_NODE_MODULES", ""), str(pathlib.Path(__file__).parent), os.getcwd(), "/usr/share", "/usr/lib"]
    folder = next((p for p in places if p and (pathlib.Path(p) / "node_modules/playwright-core").is_dir()), None)
    return (browser, node, folder) if browser and node and folder else None


def check_in_browser(file, report):
    """Drags the wipe and reads a value under the pointer in headless Chromium."""
    tools = browser_tools()
    if not tools:
        print("SKIPPED: the report was not opened in a browser. It needs chromium, node and playwright-core: apt-get install "
              "chromium nodejs npm; npm install --prefix DIR playwright-core; TALBOT_NODE_MODULES=DIR")
        return
    browser, node, folder = tools
    screenshot = os.environ.get("TALBOT_REPORT_SCREENSHOT", "")
    done = subprocess.run([node, str(pathlib.Path(__file__).with_name("report_browser.mjs")), file, browser, screenshot],
                          capture_output=True, text=True, timeout=240, env={**os.environ, "TALBOT_NODE_MODULES": folder})
    check(done.returncode == 0, f"browser: {done.stdout[-400:]}{done.stderr[-800:]}")
    if done.returncode != 0:
        return
    seen = json.loads(done.stdout)
    check(not seen["faults"], f"browser: console errors: {seen['faults']}")
    check(not seen["requests"], f"browser: requests: {seen['requests']}")
    check(abs(seen["before"] - 0.5 * seen["picture"]) < 3, f"browser: the wipe begins in the middle: {seen}")
    check(5 < seen["value"] < 40 and abs(seen["after"] - seen["picture"] * seen["value"] / 100) < 3, f"browser: the wipe follows: {seen}")
    last = report["results"][-1]
    expected = f"{last['configuration']}\n{last['curve'][-1]['samples']} samples"
    check(seen["tipShown"] and seen["tip"].startswith(expected), f"browser: under the pointer: {seen['tip']!r}, not {expected!r}")
    check(seen["points"] == sum(len(r["curve"]) for r in report["results"]), f"browser: a point for each value: {seen}")
    check(seen["rows"] == len(report["results"]), f"browser: rows: {seen}")
    why = report["why"]
    check(seen["why"] == (len(why["kinds"]) + len(why["lights"]) if why else 0), f"browser: rows of the reasons: {seen}")
    check(seen["chosen"] == "data:image/png;base64,", f"browser: a picture is chosen: {seen}")
    print("opened in a browser:", {k: seen[k] for k in ("before", "after", "tip", "points", "rows", "why")})


def check_sweep(talbot, scene, folder):
    files = {kind: str(folder / f"report.{kind}") for kind in ("json", "csv", "html", "png")}
    words = [talbot, "accuracy", scene, "--size", "48x48", "--budget", "6", "--sweep", "max-depth=1,2", "--sweep",
             "sampler=independent", "--sweep", "nee=off", "--why"]
    for kind, file in files.items():
        words += [f"--{kind}", file]
    printed = run(*words).stdout
    report = json.load(open(files["json"]))
    check(report["schema"] == "talbot-accuracy/1", "schema")
    results = {r["configuration"]: r for r in report["results"]}
    check(set(results) == {"base", "max-depth=1", "max-depth=2", "sampler=independent", "nee=off"}, f"results: {list(results)}")
    check([r["rank"] for r in report["results"]] == [1, 2, 3, 4, 5], "ranks")
    times = [r["to_target"]["seconds"] for r in report["results"]]
    known = [t for t in times if t is not None]
    check(known == sorted(known) and times[: len(known)] == known, f"ranked by seconds to the target: {times}")
    for name, r in results.items():
        for p in r["curve"]:
            check(p["lo95"] <= p["relrmse_percent"] <= p["hi95"], f"{name}: interval")
            check(math.log2(p["samples"]).is_integer(), f"{name}: powers of two")
        check([p["seconds"] for p in r["curve"]] == sorted(p["seconds"] for p in r["curve"]), f"{name}: time goes on")
    # Light that took two bounces is a large part of this scene: its loss must be found, and nothing be found elsewhere.
    for depth in ("max-depth=1", "max-depth=2"):
        bias = results[depth]["bias"]
        check(bias["significant"] and bias["floor_percent"] > 3, f"{depth}: bias {bias}")
        check(bias["brightness_percent"] < -1, f"{depth}: brightness {bias}")
        check(bias["loss_after_seconds"] is not None and bias["loss_after_seconds"] < 60, f"{depth}: pays for a while at most: {bias}")
    check(results["max-depth=1"]["bias"]["floor_percent"] > results["max-depth=2"]["bias"]["floor_percent"], "order of the floors")
    check("puts a floor" in printed, "the ledger is printed")
    why = report["why"]
    for rows in (why["kinds"], why["lights"]):
        check(abs(sum(r["error_share"] for r in rows) - 1) < 0.01, f"why: shares of the error add up: {rows}")
        check(abs(sum(r["light_share"] for r in rows) - 1) < 0.01, f"why: shares of the light add up: {rows}")
    kinds = {r["name"]: r for r in why["kinds"]}
    check(kinds["indirect"]["error_share"] + kinds["direct"]["error_share"] > 0.8, f"why: a room without mirrors: {kinds}")
    check(kinds["caustic"]["light_share"] == 0, f"why: no caustics: {kinds}")
    check(why["lights"][0]["name"] == "light" and why["lights"][0]["light_share"] > 0.99, f"why: one lamp: {why['lights']}")
    check("what the error is made of" in printed, "why: printed")
    check(results["nee=off"]["bias"] is None, "finding lights by chance is not biased")
    if results["nee=off"]["to_target"]["seconds"] is not None and results["base"]["to_target"]["seconds"] is not None:
        check(results["nee=off"]["to_target"]["seconds"] > results["base"]["to_target"]["seconds"], "light sampling pays")
    check(report["advisor"]["command"] in printed, "the advice is printed")
    check(report["advisor"]["command"].startswith("talbot "), "a command to copy")
    rows = list(csv.DictReader(open(files["csv"])))
    check(len(rows) == sum(len(r["curve"]) for r in results.values()), "a CSV row for every point")
    png = open(files["png"], "rb").read()
    check(png[:8] == b"\x89PNG\r\n\x1a\n" and struct.unpack(">II", png[16:24]) == (1000, 640), "plot")
    check_html(open(files["html"]).read(), report)
    check_in_browser(files["html"], report)


def check_ab(talbot, scene, folder):
    file = str(folder / "ab.json")
    printed = run(talbot, "accuracy", "ab", scene, "--size", "48x48", "--budget", "60", "--until-decided", "--b", "--no-nee",
                  "--json", file).stdout
    report = json.load(open(file))
    check(report["schema"] == "talbot-ab/1" and report["size"] == [48, 48], "ab: schema and size")
    verdict = report["verdict"]
    check(verdict["winner"] == "a" and verdict["hi95"] < 1, f"ab: light sampling pays: {verdict}")
    check(verdict["lo95"] <= verdict["b_over_a"] <= verdict["hi95"], f"ab: interval: {verdict}")
    check(verdict["text"] in printed and verdict["text"].startswith("A is "), f"ab: the verdict is printed: {printed}")
    check(report["a"]["relrmse_percent"] < report["b"]["relrmse_percent"], f"ab: errors: {report}")
    for words in (["--a", "--size 3x3"], ["--b", "--orbit 0,0,0,0,60,5,40"], ["--b", "--nonsense"], ["--budget", "0"]):
        run(talbot, "accuracy", "ab", scene, *words, code=2)
    run(talbot, "accuracy", "ab", "/no/such/scene.glb", code=3)


def check_adaptive(talbot, scene, folder):
    """The same film over threads, tiles and a resumed run; no parts and no merging."""
    def film_hash(*words):
        report = str(folder / "adaptive.json")
        run(talbot, scene, "--adaptive", "--size", "61x45", "--quiet", *words, "--report", report)
        record = json.load(open(report))
        check(record["adaptive"] is True, "adaptive: in the run record")
        return record["film_hash"], record["samples"]
    whole, samples = film_hash("--frames", "150", "--threads", "1")
    check(samples < 150 * 61 * 45, f"adaptive: fewer samples: {samples}")
    check(film_hash("--frames", "150", "--threads", "3", "--tile-size", "5")[0] == whole, "adaptive: threads and tiles")
    for stop in ("20", "77", "128"):
        part = str(folder / "adaptive.part")
        film_hash("--frames", stop, "--film", part)
        check(film_hash("--frames", "150", "--resume", part)[0] == whole, f"adaptive: resumed after {stop}")
    refused = run(talbot, "merge", str(folder / "out.film"), part, part, code=3)
    check("--adaptive" in refused.stderr and refused.stderr.count("\n") == 1, f"adaptive: merge: {refused.stderr}")
    refused = run(talbot, scene, "--adaptive", "--first-sample", "8", code=2)
    check(refused.stderr.count("\n") == 1, f"adaptive: a part: {refused.stderr}")
    run(talbot, "accuracy", "ab", scene, "--b", "--adaptive", code=2)


def check_list(talbot, scene, folder):
    """A list of scenes with options, and what is wrong with one."""
    listed = folder / "list.txt"
    listed.write_text(f"# two views\n{scene} --exposure 2\n\n{scene} --no-nee # by chance\n")
    done = subprocess.run([talbot, "accuracy", "certify", "--list", str(listed), "--seeds", "1", "--from", "2", "--to", "4", "--pixels",
                           "64", "--reference-factor", "4", "--stop-to", "8", "--json", "-"], capture_output=True, text=True, timeout=200)
    check(done.returncode in (0, 1), f"certify --list: {done.stderr}")
    scenes = json.loads(done.stdout)["scenes"]
    check([s["scene"] for s in scenes] == ["cornell.gltf +2 EV", "cornell.gltf no-nee"], f"certify --list: {[s['scene'] for s in scenes]}")
    check(scenes[0]["exposure_ev"] == 2, "certify --list: exposure")
    listed.write_text(f"{scene}\n{scene} --no-such\n")
    refused = run(talbot, "accuracy", "certify", "--list", str(listed), code=3)
    check("line 2" in refused.stderr and refused.stderr.count("\n") == 1, f"certify --list: {refused.stderr}")
    for text, said in ((f"{scene} --frames 3\n", "line 1"), ("# nothing\n", "no scene")):
        listed.write_text(text)
        refused = run(talbot, "accuracy", "certify", "--list", str(listed), code=3)
        check(said in refused.stderr and not refused.stdout, f"certify --list: {refused.stderr}{refused.stdout}")
    # What is given goes before --quick.
    run(talbot, "accuracy", "certify", scene, "--quick", "--seeds", "0", code=2)
    done = subprocess.run([talbot, "accuracy", "certify", scene, "--quick", "--seeds", "1", "--to", "8", "--reference-factor", "4",
                           "--json", "-"], capture_output=True, text=True, timeout=200)
    report = json.loads(done.stdout)
    check(report["seeds"] == 1 and report["milestones"] == [4, 8], f"certify --quick: {report['milestones']}")
    check(not report["kept"] and done.returncode == 1 and not report["broken"], "certify: without a green claim nothing is proved")


def main():
    talbot, source = sys.argv[1], pathlib.Path(sys.argv[2])
    scene = str(source / "assets/scenes/cornell.gltf")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_sweep(talbot, scene, folder)
        check_ab(talbot, scene, folder)
        check_adaptive(talbot, scene, folder)
        words = [talbot, "accuracy", "certify", scene, "--seeds", "2", "--from", "16", "--to", "32", "--pixels", "1024",
                 "--reference-factor", "16", "--cache", name, "--json", str(folder / "certify.json")]
        first = subprocess.run(words, capture_output=True, text=True, timeout=200)
        check(first.returncode in (0, 1), f"certify: {first.stdout}{first.stderr}")
        certificate = json.load(open(folder / "certify.json"))
        check(certificate["schema"] == "talbot-certify/1", "certify: schema")
        check((first.returncode == 0) == certificate["kept"], "certify: exit code 1 when broken")
        check(certificate["kept"] == (not certificate["broken"] and certificate["all"]["claims"] > 0), "certify: kept")
        check(len(list(folder.glob("*.film"))) == 4, "certify: references in the cache")
        claims = certificate["scenes"][0]["claims"]
        check_list(talbot, scene, folder)
        check(all(0.4 < c["relrmse_percent"] / c["truth"] < 2.5 for c in claims if c["samples"] >= 16), "certify: claims near the truth")
    for words in (["accuracy", scene, "--sweep", "depth=3"], ["accuracy", scene, "--sweep", "max-depth"],
                  ["accuracy", scene, "--sweep", "nee=maybe"], ["accuracy", scene, "--budget", "0"], ["accuracy", scene, "--target-error", "0"],
                  ["accuracy", scene, "--size", "0x0"], ["accuracy", "certify", "--seeds", "0"],
                  ["accuracy", "certify", "--from", "3"], ["accuracy", "certify", "--cache", "/no/such/folder"]):
        refused = run(talbot, *words, code=2)
        check(refused.stderr.count("\n") == 1, f"{words}: one line: {refused.stderr}")
    run(talbot, "accuracy", "/no/such/scene.glb", code=3)
    print(f"{len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Runs `talbot accuracy` as a user does and checks what it writes. Usage: check_accuracy.py TALBOT SOURCE_DIR"""
import csv
import html
import html.parser
import json
import math
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


PROBE = """<script>
const faults=[];window.onerror=(m)=>{faults.push(m);};console.error=(m)=>{faults.push(String(m));};
window.addEventListener('load',()=>{
 const over=document.querySelector('.over'),range=document.getElementById('range'),before=over.style.width;
 range.value=20;range.dispatchEvent(new Event('input'));const after=over.style.width;
 const point=document.querySelector('circle.point');point.dispatchEvent(new MouseEvent('mouseenter',{clientX:5,clientY:5}));
 const tip=document.getElementById('tip'),text=tip.textContent;
 const loads=performance.getEntriesByType('resource').filter(e=>!e.name.startsWith('data:')).map(e=>e.name);
 const out=document.createElement('pre');out.id='probe';out.textContent=JSON.stringify({before,after,text,loads,faults,
  rows:document.querySelectorAll('#table tbody tr').length,curves:document.querySelectorAll('polyline').length,
  width:document.getElementById('left').naturalWidth});document.body.append(out);});
</script>"""


def check_in_browser(file, report):
    """Moves the slider and reads a value under the pointer, where there is a browser."""
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if not browser:
        print("no chromium: the report was not opened")
        return
    page = pathlib.Path(file)
    probed = page.with_name("probed.html")
    probed.write_text(page.read_text().replace("<head>", "<head>" + PROBE, 1))
    with tempfile.TemporaryDirectory() as profile:
        done = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}",
                               "--virtual-time-budget=3000", "--dump-dom", probed.as_uri()], capture_output=True, text=True, timeout=120)
    found = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.S)
    check(found, f"browser: no answer: {done.stderr[-400:]}")
    if not found:
        return
    seen = json.loads(html.unescape(found[1]))
    check(not seen["faults"], f"browser: {seen['faults']}")
    check(not seen["loads"], f"browser: loaded {seen['loads']}")
    check(seen["before"] != seen["after"] and seen["after"].endswith("px"), f"browser: the wipe: {seen}")
    check("samples" in seen["text"] and "%" in seen["text"], f"browser: under the pointer: {seen['text']}")
    check(seen["rows"] == seen["curves"] == len(report["results"]), f"browser: rows and curves: {seen}")
    check(seen["width"] == report["size"][0], f"browser: picture: {seen}")


def check_sweep(talbot, scene, folder):
    files = {kind: str(folder / f"report.{kind}") for kind in ("json", "csv", "html", "png")}
    words = [talbot, "accuracy", scene, "--size", "48x48", "--budget", "6", "--sweep", "max-depth=1,2", "--sweep",
             "sampler=independent", "--sweep", "nee=off"]
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
    check(results["max-depth=1"]["bias"]["floor_percent"] > results["max-depth=2"]["bias"]["floor_percent"], "order of the floors")
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


def main():
    talbot, source = sys.argv[1], pathlib.Path(sys.argv[2])
    scene = str(source / "assets/scenes/cornell.gltf")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_sweep(talbot, scene, folder)
        words = [talbot, "accuracy", "certify", scene, "--seeds", "2", "--from", "16", "--to", "32", "--pixels", "256",
                 "--reference-factor", "16", "--cache", name, "--json", str(folder / "certify.json")]
        first = subprocess.run(words, capture_output=True, text=True, timeout=200)
        check(first.returncode in (0, 1), f"certify: {first.stdout}{first.stderr}")
        certificate = json.load(open(folder / "certify.json"))
        check(certificate["schema"] == "talbot-certify/1", "certify: schema")
        check((first.returncode == 1) == bool(certificate["broken"]), "certify: exit code 1 when broken")
        check(len(list(folder.glob("*.film"))) == 4, "certify: references in the cache")
        claims = certificate["scenes"][0]["claims"]
        check(all(0.4 < c["relrmse_percent"] / c["truth"] < 2.5 for c in claims if c["samples"] >= 16), "certify: claims near the truth")
    for words in (["accuracy", scene, "--sweep", "depth=3"], ["accuracy", scene, "--sweep", "max-depth"],
                  ["accuracy", scene, "--sweep", "nee=maybe"], ["accuracy", scene, "--budget", "0"],
                  ["accuracy", scene, "--size", "0x0"], ["accuracy", "certify", "--seeds", "0"],
                  ["accuracy", "certify", "--from", "3"], ["accuracy", "certify", "--cache", "/no/such/folder"]):
        refused = run(talbot, *words, code=2)
        check(refused.stderr.count("\n") == 1, f"{words}: one line: {refused.stderr}")
    run(talbot, "accuracy", "/no/such/scene.glb", code=3)
    print(f"{len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

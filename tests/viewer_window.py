#!/usr/bin/env python3
"""Drives the real window under Xvfb with xdotool and looks at the pixels of the screen. Exits 77 when a tool is missing."""
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import time

SKIP = 77
SCREEN = (1280, 800)


class Screen:
    """The virtual framebuffer, as the file that Xvfb maps it to (XWD, version 7)."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        fields = struct.unpack(">25I", data[:100])
        self.width, self.height = fields[4], fields[5]
        self.bits, self.stride = fields[11], fields[12]
        self.offset = fields[0] + fields[19] * 12
        self.data = data

    def pixel(self, x, y):
        at = self.offset + y * self.stride + x * self.bits // 8
        blue, green, red = self.data[at : at + 3]
        return red, green, blue

    def area(self, left, top, right, bottom, step=7):
        return [self.pixel(x, y) for y in range(top, bottom, step) for x in range(left, right, step)]


def difference(a, b):
    """Mean absolute difference of two lists of pixels, in 8-bit steps."""
    return sum(abs(p[c] - q[c]) for p, q in zip(a, b) for c in range(3)) / (3 * len(a))


class Failure(Exception):
    pass


def wait_for(what, condition, seconds=60):
    end = time.time() + seconds
    while time.time() < end:
        if condition():
            return
        time.sleep(0.1)
    raise Failure(f"{what}: not within {seconds} s")


class Desktop:
    """Xvfb and the program in it."""

    def __init__(self, binary, scene, folder):
        self.folder = folder
        read_end, write_end = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write_end), "-screen", "0", f"{SCREEN[0]}x{SCREEN[1]}x24", "-fbdir", folder,
             "-nolisten", "tcp"],
            pass_fds=[write_end], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write_end)
        with os.fdopen(read_end) as pipe:
            number = pipe.readline().strip()
        if not number:
            raise Failure("Xvfb does not start")
        self.environment = dict(os.environ, DISPLAY=f":{number}")
        self.environment.pop("WAYLAND_DISPLAY", None)
        self.log = open(os.path.join(folder, "talbot.log"), "w+")
        self.program = subprocess.Popen([binary, scene], env=self.environment, cwd=folder, stdout=self.log,
                                        stderr=self.log)

    def do(self, *words):
        subprocess.run(["xdotool", *map(str, words)], env=self.environment, check=True, stdout=subprocess.DEVNULL,
                       timeout=20)

    def find_window(self):
        if self.program.poll() is not None:
            self.log.seek(0)
            raise Failure(f"the program ended with {self.program.returncode}: {self.log.read()}")
        found = subprocess.run(["xdotool", "search", "--onlyvisible", "--class", "talbot"], env=self.environment,
                               stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, timeout=20)
        return found.stdout.split()

    def screen(self):
        return Screen(os.path.join(self.folder, "Xvfb_screen0"))

    def close(self):
        for process in (self.program, self.server):
            if process.poll() is None:
                process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()


def centre_of_image(desktop):
    """A square in the middle of the screen, between the panels."""
    x, y = SCREEN[0] // 2, SCREEN[1] // 2
    return desktop.screen().area(x - 120, y - 150, x + 120, y + 150)


def is_picture(pixels):
    return len(set(pixels)) > 50 and max(max(p) for p in pixels) > 60


def check(desktop):
    wait_for("the window opens", lambda: desktop.find_window())
    window = desktop.find_window()[0]
    desktop.do("windowmove", window, 0, 0)
    desktop.do("windowsize", window, *SCREEN)
    desktop.do("windowfocus", window)
    wait_for("the image fills the middle", lambda: is_picture(centre_of_image(desktop)))
    wait_for("the panels fill the sides", lambda: len(set(desktop.screen().area(5, 5, 300, 600))) > 8)
    print("window, panels and image are on the screen")

    # A drag over the image turns the view, and the image changes far beyond noise.
    desktop.do("key", "space")  # pause
    time.sleep(0.5)
    still = centre_of_image(desktop)
    time.sleep(1)
    noise = difference(still, centre_of_image(desktop))
    desktop.do("key", "space")
    desktop.do("mousemove", 640, 400, "mousedown", 1)
    for step in range(12):
        desktop.do("mousemove", 640 + 12 * step, 400 - 3 * step)
    desktop.do("mouseup", 1)
    wait_for("the view follows the drag", lambda: difference(still, centre_of_image(desktop)) > max(6, 4 * noise))
    print(f"orbit seen: difference {difference(still, centre_of_image(desktop)):.1f} against {noise:.2f} while paused")

    # Exposure keys brighten and darken what is shown.
    def brightness():
        pixels = centre_of_image(desktop)
        return sum(sum(p) for p in pixels) / len(pixels)

    def settled():
        first = centre_of_image(desktop)
        time.sleep(0.6)
        return difference(first, centre_of_image(desktop)) < 1.5

    wait_for("the image settles after the drag", settled)
    before = brightness()
    for _ in range(6):
        desktop.do("key", "bracketleft")
    wait_for("the exposure keys darken the image", lambda: brightness() < 0.75 * before)
    desktop.do("key", "0")
    wait_for("0 takes the exposure back", lambda: brightness() > 0.85 * before)
    print("exposure seen")

    # Tab hides the panels, so the image reaches the left edge.
    side = desktop.screen().area(5, 100, 300, 600)
    desktop.do("key", "Tab")
    wait_for("Tab hides the panels", lambda: difference(side, desktop.screen().area(5, 100, 300, 600)) > 5)
    desktop.do("key", "Tab")
    wait_for("Tab brings them back", lambda: difference(side, desktop.screen().area(5, 100, 300, 600)) < 5)
    print("panels hide and come back")

    # A smaller window keeps a picture in its middle.
    desktop.do("windowsize", window, 1000, 640)
    wait_for("the image survives a resize",
             lambda: is_picture(desktop.screen().area(420, 200, 580, 420)) and desktop.program.poll() is None)
    print("resize seen")

    # Ctrl+S writes a picture, Ctrl+Q ends the program with 0.
    desktop.do("key", "ctrl+s")
    wait_for("Ctrl+S saves", lambda: os.path.exists(os.path.join(desktop.folder, "talbot.png")))
    desktop.do("key", "ctrl+q")
    wait_for("Ctrl+Q quits", lambda: desktop.program.poll() is not None)
    if desktop.program.returncode != 0:
        raise Failure(f"the program ended with {desktop.program.returncode}")
    print("saved and quit")


def main():
    binary, scene = map(os.path.abspath, sys.argv[1:3])
    for tool in ("Xvfb", "xdotool"):
        if not shutil.which(tool):
            print(f"SKIPPED: {tool} is not installed, THE WINDOW IS NOT TESTED (apt-get install xvfb xdotool)")
            return SKIP
    with tempfile.TemporaryDirectory() as folder:
        desktop = None
        try:
            desktop = Desktop(binary, scene, folder)
            check(desktop)
        except Failure as failure:
            print(f"FAILED: {failure}")
            if desktop:
                keep = os.path.join(tempfile.gettempdir(), "talbot-window-failure.xwd")
                shutil.copy(os.path.join(folder, "Xvfb_screen0"), keep)
                print(f"the screen at that time: {keep}")
            return 1
        finally:
            if desktop:
                desktop.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())

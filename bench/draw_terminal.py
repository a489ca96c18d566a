#!/usr/bin/env python3
"""Draws what commands print on a terminal as an SVG, for the pages of docs/.

  bench/draw_terminal.py OUT.svg [--columns N] [--lines N] COMMAND...

COMMAND: one argument each, run by the shell one after the other on a terminal of so many columns.
Of each the last --lines lines are drawn. Exit code 1, and no picture, when a command fails.
"""
import argparse
import fcntl
import html
import os
import pty
import re
import struct
import subprocess
import sys
import termios

CHARACTER, LINE, MARGIN = 7.8, 18, 14  # pixels
COLOURS = {"31": "#ff8f80", "32": "#8fdc8f", "33": "#ffd479", "34": "#8fb8ff"}


def output_of(command, columns):
    """What a command writes to a terminal, as the lines that stay there."""
    leader, follower = pty.openpty()
    fcntl.ioctl(follower, termios.TIOCSWINSZ, struct.pack("4H", 50, columns, 0, 0))
    child = subprocess.Popen(command, shell=True, stdin=follower, stdout=follower, stderr=follower)
    os.close(follower)
    text = b""
    while True:
        try:
            piece = os.read(leader, 65536)
        except OSError:  # a terminal's end, once nobody has it open any more
            break
        if not piece:
            break
        text += piece
    os.close(leader)
    if child.wait() != 0:
        sys.exit(f"'{command}' failed:\n{text.decode(errors='replace')}")
    lines = text.decode(errors="replace").replace("\r\n", "\n").rstrip("\n").split("\n")
    return [line.rstrip("\r").split("\r")[-1] for line in lines]


def spans(line):
    """A line with colour codes as SVG."""
    colour, drawn = None, ""
    for piece in re.split(r"(\x1b\[[0-9;]*[A-Za-z])", line):
        if piece.startswith("\x1b"):
            codes = [code for code in piece[2:-1].split(";") if code in COLOURS]
            colour = COLOURS[codes[0]] if codes else None
        elif piece:
            fill = f' fill="{colour}"' if colour else ""
            text = html.escape(piece).replace(" ", "\u00a0")  # which no viewer joins
            drawn += f"<tspan{fill}>{text}</tspan>"
    return drawn


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("out")
    parser.add_argument("commands", nargs="+", metavar="COMMAND")
    parser.add_argument("--columns", type=int, default=110)
    parser.add_argument("--lines", type=int, default=40)
    asked = parser.parse_args()
    lines = []
    for command in asked.commands:
        said = output_of(command, asked.columns)[-asked.lines:]
        lines += [f"\x1b[32m$\x1b[0m {command}", *said, ""]
    width, height = round(asked.columns * CHARACTER) + 2 * MARGIN, len(lines) * LINE + MARGIN
    title = html.escape("; ".join(asked.commands))
    with open(asked.out, "w", encoding="utf-8") as out:
        out.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
                  f'font-family="monospace" font-size="13">\n<title>{title}</title>\n'
                  f'<rect width="{width}" height="{height}" rx="8" fill="#1d2430"/>\n'
                  '<g fill="#dde3ea">\n')
        for i, line in enumerate(lines[:-1]):
            if line:
                y = MARGIN + (i + 1) * LINE - 4
                out.write(f'<text x="{MARGIN}" y="{y}">{spans(line)}</text>\n')
        out.write("</g>\n</svg>\n")


if __name__ == "__main__":
    main()

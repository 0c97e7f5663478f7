#!/usr/bin/env python3
"""Command lines of hertzline are completed in a real shell: completion_in_shell.py SHELL PROGRAM [PREFIX]

The shell runs in a terminal: it gets the beginning of a line, a tab and the rest of the line, and shows the words that it then has. fish
is asked for its completions instead. With PREFIX the script is the one installed there, found as the shell finds it, else the one that the
program prints. Exit status 77 where there is no such shell.
"""
import os
import pathlib
import pty
import re
import shutil
import subprocess
import sys
import tempfile

shell, program, *prefix = sys.argv[1:]
BASH_COMPLETION = "/usr/share/bash-completion/bash_completion"
if not shutil.which(shell) or (shell == "bash" and prefix and not os.path.exists(BASH_COMPLETION)):
    print(f"skipped: {shell} is not installed")
    sys.exit(77)

# typed before the tab, and the last word then; None: as typed
CASES = [
    ("mater", "materials"),
    ("run paper-vit", "paper-vitreous-carbon"),
    ("run paper-wall --spectr", "--spectrum"),
    ("run paper-wall --set chain.preload_n", "chain.preload_n="),
    ("run paper-wall --set end.material=pyr", "end.material=pyrex"),
    ("run paper-wall --set=end.kind=wa", "--set=end.kind=wall"),
    ("run --columns v_out,v_la", "v_out,v_last"),
    ("sweep paper-wall --vary end.material=pyrex,acr", "end.material=pyrex,acrylic"),
    ("optimise paper-wall --maximise first_arr", "first_arrival_s"),
    ("listen --stream x_", "x_horn"),
    ("run my-sc", "my-scene.toml"),
    ("plot recor", "recording one.npy"),
    ("scope --record-to bur", "bursts/"),
    ("sweep paper-wall --jobs my-sc", None),  # no file is a number
    ("scope --record-to my-sc", None),  # nor a folder
]
# the same in terminals, where quotes are open
QUOTED = [
    ("check paper-wall --set 'end.material=pyr", "end.material=pyrex"),
    ('check paper-wall --set "end.material=pyr', "end.material=pyrex"),
]


class Terminal:
    """A shell in a terminal."""

    def __init__(self, command, environment, folder):
        self.process, self.descriptor = pty.fork()
        if self.process == 0:
            os.chdir(folder)
            os.execvpe(command[0], command, environment)
        self.said = ""

    def send(self, text):
        os.write(self.descriptor, text.encode())

    def wait_for(self, pattern):
        """Reads until the pattern is there; the test's own limit of time ends it else."""
        while not (found := re.search(pattern, self.said)):
            self.said += os.read(self.descriptor, 65536).decode(errors="replace")
        self.said = self.said[found.end():]
        return found

    def line_with_tab(self, before, after):
        """The words of the line; in the terminal the typed line never holds "<hertzline>"."""
        self.send(f"{before}\t{after}\x01printf '<%s>' ")  # Ctrl-A: to the beginning
        self.send("\n")
        return re.findall("<(.*?)>", self.wait_for(r"<[^<>]*hertzline>(<[^<>]*>)*")[0])


def in_terminal(folder, environment):
    if shell == "bash":
        command = ["bash", "--norc", "--noprofile", "-i"]
        setup = f"source {BASH_COMPLETION}" if prefix else "source <(hertzline completion bash)"
    else:
        command = ["zsh", "-f", "-i"]
        places = f"fpath=({prefix[0]}/share/zsh/site-functions $fpath); " if prefix else ""
        setup = places + "autoload -Uz compinit; compinit -u -D" + ("" if prefix else "; source <(hertzline completion zsh)")
    terminal = Terminal(command, environment, folder)
    terminal.send(f"{setup}; echo REA''DY\n")
    terminal.wait_for("READY")
    for typed, completed in CASES + QUOTED:
        words = terminal.line_with_tab(f"hertzline {typed}", "end")
        last = completed or typed.split()[-1]
        expected = [last, "end"] if completed and last[-1] not in "=/" else [last + "end"]  # a blank after a whole word
        assert words[-len(expected):] == expected, f"{typed}<tab>end: found {words}, expected {expected} at the end"
    if not prefix:  # an installed program is completed by its name
        terminal.send(f"mkdir 'with blank'; ln -s {program} 'with blank/hertzline'\n")
        words = terminal.line_with_tab("with\\ blank/hertzline mater", "end")
        assert words[1:] == ["materials", "end"], f"in a folder with a blank: found {words}"
    terminal.send("exit\n")
    os.waitpid(terminal.process, 0)


def in_fish(folder, environment):
    setup = "" if prefix else "hertzline completion fish | source; "
    for typed, completed in CASES:
        command = ["fish", "-c", f"{setup}complete -C 'hertzline {typed}'"]
        answer = subprocess.run(command, check=True, capture_output=True, text=True, env=environment, cwd=folder).stdout
        words = [line.split("\t")[0].replace("\\ ", " ") for line in answer.splitlines()]
        assert words == ([completed] if completed else []), f"{typed}: found {words}, expected {completed}"


with tempfile.TemporaryDirectory() as place:
    work = pathlib.Path(place)
    (work / "my-scene.toml").touch()
    (work / "recording one.npy").touch()
    (work / "bursts").mkdir()
    environment = {"PATH": f"{pathlib.Path(program).parent}:{os.environ['PATH']}", "HOME": place, "TERM": "dumb", "LC_ALL": "C.UTF-8"}
    if prefix:
        environment["XDG_DATA_DIRS"] = f"{prefix[0]}/share:/usr/share"
    (in_fish if shell == "fish" else in_terminal)(work, environment)

"""The commands, and how their ends become exit statuses.

0: done, and the verdict is *met*. 1: done, and it is another. 2: bad input or usage. 3: could not
finish. 130: interrupted.

Only typer is imported here, so that ``--help`` answers at once.
"""

from __future__ import annotations

import errno
import os
import signal
import sys
from pathlib import Path
from typing import Annotated

import typer

from mptune.cli.campaign import campaign
from mptune.cli.compare import compare
from mptune.cli.explore import explore
from mptune.cli.export import export
from mptune.cli.identify import identify
from mptune.cli.journey import Journey
from mptune.cli.options import (
    OUT,
    ForceOption,
    GainsOption,
    JsonOption,
    OutOption,
    QuietOption,
    SetOption,
    StudyArgument,
    StudyToWarm,
    TimesOption,
    UncertaintyOption,
    a_path,
    finish,
)
from mptune.cli.run import run
from mptune.cli.streams import take_streams
from mptune.cli.studies import studies
from mptune.cli.systems import systems
from mptune.cli.tune import tune
from mptune.cli.weights import weights
from mptune.escaping import printable

BAD_INPUT, UNFINISHED, INTERRUPTED = 2, 3, 130

app = typer.Typer(
    cls=Journey,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Robust tuning of hydraulic cylinders driven from several supply pressures.\n\n"
    "Write a study with `new`; `run` does the whole job. Or go step by step: `sweep` judges gains, "
    "`tune` finds better ones, `verify` proves them on the nonlinear machine, `export` hands them "
    "to a controller. `mptune COMMAND --help` says more.",
)


@app.callback(invoke_without_command=True)
def _version(
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    if version:
        from mptune.params.gains import version as number

        typer.echo(number())
        raise typer.Exit


app.command()(run)


@app.command()
def sweep(
    study: StudyArgument,
    gains: GainsOption = None,
    override: SetOption = None,
    uncertainty: UncertaintyOption = "",
    out: OutOption = OUT,
    json: JsonOption = False,
    quiet: QuietOption = False,
    _verbose: TimesOption = False,
) -> None:
    """Draw and store both sides of both inequalities over the grid."""
    from mptune.cli import show
    from mptune.cli.study import load_study, with_warnings
    from mptune.job.gains import with_gains
    from mptune.job.sweep import sweep_study
    from mptune.robust.headline import judge

    loaded, _, differs = with_gains(load_study(study, override or (), uncertainty), gains)
    with show.progress(quiet=quiet) as report:
        result, links, files = sweep_study(loaded, None, out, report)
    judgement = judge(result.checks, links)
    if json:
        values = {
            **judgement.json(),
            **result.json(),
            "chain": [link.json() for link in links],
            "differs": [one.json() for one in differs],
        }
        show.as_json(with_warnings(values, loaded))
    else:
        show.headline(judgement)
        show.elsewhere(differs)
        show.sweep(result, links)
        show.files(files)
    finish(met=judgement.met)


@app.command()
def verify(
    study: StudyArgument,
    gains: GainsOption = None,
    force: ForceOption = False,
    override: SetOption = None,
    uncertainty: UncertaintyOption = "",
    out: OutOption = OUT,
    json: JsonOption = False,
    quiet: QuietOption = False,
    _verbose: TimesOption = False,
) -> None:
    """Prove gains on the nonlinear machine."""
    from mptune.cli import show
    from mptune.cli.study import load_study, with_warnings
    from mptune.job.verify import verify_study

    loaded = load_study(study, override or (), uncertainty)
    with show.progress(quiet=quiet) as report:
        result = verify_study(loaded, gains, out, report, force=force)
    if json:
        show.as_json(with_warnings(result.json(), loaded))
    else:
        show.headline(result.judgement)
        show.elsewhere(result.differs)
        show.verified(result.verified)
        show.files(result.files)
    finish(met=result.judgement.met)


app.command()(tune)
app.command()(identify)
app.command()(weights)
app.command()(campaign)
app.command()(export)
app.command()(compare)
app.command()(systems)
app.command()(studies)
app.command()(explore)


@app.command()
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the study's folder.")],
    folder: Annotated[
        Path, typer.Option("--in", parser=a_path, metavar="DIR", help="Where studies live.")
    ] = Path("studies"),
    like: Annotated[
        str,
        typer.Option(metavar="STUDY", help="Copy a bundled study, such as crane, or one's file."),
    ] = "",
    quiet: QuietOption = False,
) -> None:
    """Write a study to start from."""
    from mptune.cli import show
    from mptune.params.template import write_template

    written = write_template(folder, name, like)
    if not quiet:
        show.files((written,))


@app.command()
def warm(
    study: StudyToWarm = None, quiet: QuietOption = False, _verbose: TimesOption = False
) -> None:
    """Compile all that a run needs, once, so that the first run is as fast as the next."""
    from mptune.cli import show
    from mptune.cli.study import load_study
    from mptune.job.warm import warm as warm_kernels

    loaded = None if study is None else load_study(study)
    with show.progress(quiet=quiet) as report:
        folder = warm_kernels(report, loaded)
    if not quiet:
        show.say(f"kernels are kept in {folder}" if folder else "no folder for kernels: none kept")


@app.command()
def ledger() -> None:
    """Print where mptune differs from the paper, and why."""
    from mptune.cli import show

    show.ledger()


def main() -> None:
    """Run the command line and leave with its exit status."""
    out = take_streams()
    # Threads that wait for the next compiled loop sleep: the simulation beside has use for a core.
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    # Matrices have ten to a hundred rows: a second thread of the linear algebra would but wait.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.unraisablehook = _unraisable
    code = status(sys.argv[1:])
    sys.stdout.flush()
    if out.failure is not None:
        reason = out.failure.strerror or out.failure
        rule = f"standard output could not be written ({reason}); what was to be printed is lost"
        code = _say(f"{rule}; free some space or print elsewhere", UNFINISHED)
    sys.stderr.flush()
    # What is done is done: Python, while it takes itself apart, would die of an interrupt.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.exit(code)


def _unraisable(caught: sys.UnraisableHookArgs) -> None:
    """Pass over what h5netcdf's destructor raises on a file whose opening was interrupted."""
    of_a_file = getattr(caught.object, "__module__", "").startswith("h5netcdf")
    interrupted = isinstance(caught.exc_value, KeyboardInterrupt)
    if not interrupted and not (of_a_file and isinstance(caught.exc_value, AttributeError)):
        sys.__unraisablehook__(caught)


def status(arguments: list[str]) -> int:
    """Return the exit status of a command line, having said on stderr what went wrong."""
    try:
        code = app(args=arguments, prog_name="mptune", standalone_mode=False)
    except typer.Exit as done:
        code = done.exit_code
    except (typer.Abort, KeyboardInterrupt):
        code = INTERRUPTED
    except Exception as error:  # noqa: BLE001 - the last line of defence, with its own status
        return _failed(error)
    if code == INTERRUPTED:
        return _say("interrupted; nothing was left half-written", INTERRUPTED)
    return code if isinstance(code, int) else 0


def _failed(error: Exception) -> int:
    from mptune.errors import InputError, MptuneError

    show = getattr(error, "show", None)
    if callable(show):  # a usage error of typer, whose class depends on typer's version
        show()
        return BAD_INPUT
    if isinstance(error, InputError):
        return _say(str(error), BAD_INPUT)
    if isinstance(error, MptuneError):
        return _say(str(error), UNFINISHED)
    if isinstance(error, OSError) and error.errno in {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}:
        place = error.filename or "the folder for results or for temporary files"
        text = f"{place}: {error.strerror}; nothing was left half-written; free some space"
        return _say(text, UNFINISHED)
    import traceback

    where = traceback.extract_tb(error.__traceback__)[-1]
    text = f"unforeseen error: {type(error).__name__}: {error} ({where.name}, line {where.lineno})"
    return _say(f"{text}; this is a defect of mptune, please report it", UNFINISHED)


def _say(text: str, code: int) -> int:
    sys.stderr.write(f"mptune: {printable(text, keep=chr(10))}\n")
    return code

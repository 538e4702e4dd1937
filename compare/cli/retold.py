"""The command line told again, so that a report can name what made it."""

from __future__ import annotations

import shlex

import click


def command_of(context: click.Context) -> str:
    """The command line of a context: what was given, in the order of the command's options, without the defaults."""
    words = [context.command_path]
    for parameter in context.command.params:
        if parameter.name is None or context.get_parameter_source(parameter.name) is not GIVEN:
            continue
        value = context.params[parameter.name]
        if isinstance(parameter, click.Argument):
            words += [shlex.quote(str(one)) for one in (value if isinstance(value, tuple) else (value,))]
        elif isinstance(parameter, click.Option) and parameter.is_flag:
            words.append(parameter.opts[0])
        else:
            words += [parameter.opts[0], shlex.quote(str(value))]
    return " ".join(words)


GIVEN = click.core.ParameterSource.COMMANDLINE
"""Where a value comes from that the user has typed."""

/* The commands. Each gets its own part of the command line (argv[0] is the command's name) and returns the exit code, after printing
 * `gnomon: error: ...` when that is not 0. */
#pragma once

struct error;

int command_serve(int argc, char **argv);
int command_render(int argc, char **argv);
int command_compare(int argc, char **argv);
int command_bench(int argc, char **argv);
int command_check(int argc, char **argv);
int command_list(int argc, char **argv);

/* Prints the one line that every failure prints; returns the exit code. */
int command_fail(const struct error *err);

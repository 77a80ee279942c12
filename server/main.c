#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/error.h"
#include "command.h"
#include "output.h"

static const struct command {
    const char *name;
    const char *summary;
    int (*run)(int argc, char **argv); /* NULL: not built yet */
} commands[] = {
    {"serve", "serve scenes to browsers and scripts over HTTP and WebSocket", command_serve},
    {"render", "render a scene to a picture file", command_render},
    {"compare", "measure a shadow system's error against ray tracing", command_compare},
    {"bench", "measure every system on a suite of scenes", command_bench},
    {"batch", "render many frames, on this machine or a farm", NULL},
    {"check", "load, validate and summarise a scene", command_check},
    {"list", "list scenes, algorithms or devices", command_list},
};

enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

static int print_help(void)
{
    printf("Usage: gnomon COMMAND [arguments]\n\n"
           "Renders 3D scenes with shadows whose error against ray tracing is known.\n\nCommands:\n");
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        printf("  %-10s%s%s\n", commands[i].name, commands[i].summary, commands[i].run ? "" : " (not built yet)");
    printf("\nA SCENE is a .gltf or .glb file, or builtin:NAME[:key=value,...]; FILE - is standard output.\n"
           "gnomon COMMAND --help tells more; gnomon --version prints the version.\n\n"
           "Exit codes: 0 done; 64 wrong usage; 65 bad scene or image data; 66 no such scene; 69 no usable device;\n"
           "70 a bug; 74 reading or writing failed; 75 try again later.\n\n"
           "Examples:\n"
           "  gnomon render builtin:dragon -o dragon.png --algorithm sm:size=2048\n"
           "  gnomon compare builtin:ball --algorithm pcf --against samples32 -o difference.png\n"
           "  gnomon serve --listen 127.0.0.1:8080\n");
    return 0;
}

static int usage_error(const char *format, const char *word)
{
    struct error err = {0};
    char names[160] = "";
    size_t used = 0;
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "", commands[i].name);
    char what[120];
    snprintf(what, sizeof what, format, word);
    error_set(&err, ERROR_USAGE, "command", "%s; %s, --help and --version are accepted", what, names);
    return command_fail(&err);
}

static int run_command(const struct command *command, int argc, char **argv)
{
    if (command->run)
        return command->run(argc, argv);
    struct error err = {0};
    error_set(&err, ERROR_USAGE, "command", "gnomon %s is not built yet", command->name);
    return command_fail(&err);
}

static int dispatch(int argc, char **argv)
{
    if (argc < 2)
        return usage_error("no command given%s", "");
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h") || !strcmp(argv[1], "help"))
        return print_help();
    if (!strcmp(argv[1], "--version")) {
        printf("gnomon %s\n", GNOMON_VERSION);
        return 0;
    }
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        if (!strcmp(argv[1], commands[i].name))
            return run_command(&commands[i], argc - 1, argv + 1);
    return usage_error("unknown command '%.60s'", argv[1]);
}

/* A closed standard descriptor would be handed to the next file opened. /dev/null read-only in its place: writing to it fails, as
 * writing to a closed one does. */
static void occupy_standard_descriptors(void)
{
    int fd;
    do
        fd = open("/dev/null", O_RDONLY);
    while (fd >= 0 && fd <= STDERR_FILENO);
    if (fd > STDERR_FILENO)
        close(fd);
}

int main(int argc, char **argv)
{
    occupy_standard_descriptors();
    signal(SIGPIPE, SIG_IGN); /* a closed pipe is an I/O error with a message */
    int code = dispatch(argc, argv);
    struct error err = {0};
    if (code == 0 && !output_flush(&err))
        return command_fail(&err);
    return code;
}

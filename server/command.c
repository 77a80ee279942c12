#include "command.h"

#include <stdio.h>

#include "base/error.h"

int command_fail(const struct error *err)
{
    /* What was written to standard output before goes out before the complaint. */
    fflush(stdout);
    fprintf(stderr, "gnomon: error: %s\n", err->message);
    return err->code == ERROR_NONE ? ERROR_BUG : (int)err->code;
}

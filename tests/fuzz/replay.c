/* Stands in for libFuzzer's main in builds without it: each file of the folders named goes through the target once. An empty or missing
 * folder is a failure: a replay of nothing proves nothing. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define INPUT_MAX (16u << 20)

static int replay_file(const char *path)
{
    FILE *f = fopen(path, "rb");
    if (!f) {
        perror(path);
        return 1;
    }
    uint8_t *buffer = malloc(INPUT_MAX);
    size_t size = buffer ? fread(buffer, 1, INPUT_MAX, f) : 0;
    fclose(f);
    /* A block of the input's own size, so that reading past its end is seen. */
    uint8_t *exact = buffer ? realloc(buffer, size ? size : 1) : NULL;
    if (!exact)
        return free(buffer), 1;
    printf("%s\n", path);
    fflush(stdout);
    LLVMFuzzerTestOneInput(exact, size);
    free(exact);
    return 0;
}

static int replay_folder(const char *folder)
{
    struct dirent **entries;
    int n = scandir(folder, &entries, NULL, alphasort), count = 0, bad = 0;
    for (int i = 0; i < n; i++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
        if (entries[i]->d_name[0] != '.') {
            bad += replay_file(path);
            count++;
        }
        free(entries[i]);
    }
    if (n >= 0)
        free(entries);
    if (count == 0)
        fprintf(stderr, "%s: no inputs\n", folder);
    return count == 0 || bad;
}

int main(int argc, char **argv)
{
    int bad = argc < 2;
    for (int i = 1; i < argc; i++)
        bad |= replay_folder(argv[i]);
    return bad;
}

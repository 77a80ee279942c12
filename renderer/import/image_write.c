#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/error.h"
#include "import/import.h"

bool image_format_from_name(const char *name, enum image_format *out)
{
    static const struct {
        const char *extension;
        enum image_format format;
    } known[] = {{".png", IMAGE_PNG}, {".jpg", IMAGE_JPEG}, {".jpeg", IMAGE_JPEG}, {".webp", IMAGE_WEBP}, {".exr", IMAGE_EXR}};
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && i < sizeof known / sizeof *known; i++) {
        if (strcasecmp(dot, known[i].extension) == 0) {
            *out = known[i].format;
            return true;
        }
    }
    return false;
}

static bool write_all(int fd, const uint8_t *data, size_t size)
{
    while (size > 0) {
        ssize_t n = write(fd, data, size);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return false;
        data += n;
        size -= (size_t)n;
    }
    return true;
}

/* Readers see the old file or the whole new one; a name that starts with a dot matches no frame pattern. */
static bool replace_file(const char *path, const uint8_t *data, size_t size, struct error *err)
{
    char temporary[PATH_MAX];
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    int n = snprintf(temporary, sizeof temporary, "%.*s.%s.tmp-%ld", (int)(name - path), path, name, (long)getpid());
    if (n < 0 || (size_t)n >= sizeof temporary)
        return error_set(err, ERROR_IO, NULL, "%s: the name is too long", path);
    int fd = open(temporary, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd < 0)
        return error_set(err, ERROR_IO, NULL, "%s cannot be written: %s", path, strerror(errno));
    bool ok = write_all(fd, data, size) && fsync(fd) == 0;
    int why = errno;
    if (close(fd) != 0 && ok) {
        ok = false;
        why = errno;
    }
    if (ok && rename(temporary, path) != 0) {
        ok = false;
        why = errno;
    }
    if (ok)
        return true;
    unlink(temporary);
    return error_set(err, ERROR_IO, NULL, "%s cannot be written: %s", path, strerror(why));
}

bool image_write_bytes(const char *path, const uint8_t *data, size_t size, struct error *err)
{
    if (strcmp(path, "-") != 0)
        return replace_file(path, data, size, err);
    return write_all(STDOUT_FILENO, data, size) ||
           error_set(err, ERROR_IO, NULL, "standard output cannot be written: %s", strerror(errno));
}

bool image_write(const char *path, enum image_format format, const void *pixels, uint32_t width, uint32_t height, int quality,
                 const struct image_metadata *metadata, size_t metadata_count, struct error *err)
{
    uint8_t *data = NULL;
    size_t size = 0;
    if (!image_encode(format, pixels, width, height, quality, metadata, metadata_count, &data, &size, err))
        return false;
    bool ok = image_write_bytes(path, data, size, err);
    free(data);
    return ok;
}

#include "import/folder.hh"

#include <cerrno>
#include <fcntl.h>
#include <linux/openat2.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <vector>

#include "import/failure.hh"

namespace gltf
{
namespace
{

struct descriptor {
    int fd;
    explicit descriptor(int f) : fd(f) {}
    descriptor(const descriptor &) = delete;
    ~descriptor()
    {
        if (fd >= 0)
            close(fd);
    }
};

bytes read_all(int fd, size_t size, const char *what)
{
    bytes out(size);
    size_t done = 0;
    while (done < size) {
        ssize_t n = ::read(fd, out.data.get() + done, size - done);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            fail_with(ERROR_IO, "%s cannot be read: %s", what, strerror(errno));
        if (n == 0)
            break;
        done += static_cast<size_t>(n);
    }
    out.size = done;
    return out;
}

bytes read_regular(int fd, const char *what, uint64_t limit)
{
    struct stat info;
    if (fstat(fd, &info) != 0)
        fail_with(ERROR_IO, "%s cannot be read: %s", what, strerror(errno));
    if (!S_ISREG(info.st_mode))
        fail("%s is not a regular file; only regular files are read", what);
    if (static_cast<uint64_t>(info.st_size) > limit)
        fail("%s has %llu bytes, at most %llu are accepted", what, static_cast<unsigned long long>(info.st_size),
             static_cast<unsigned long long>(limit));
    return read_all(fd, static_cast<size_t>(info.st_size), what);
}

int hex_digit(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    c = static_cast<char>(c | 0x20);
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* RFC 3986, 2.1; a % that starts no escape stays. */
std::string percent_decode(const std::string &text)
{
    std::string out;
    out.reserve(text.size());
    for (size_t i = 0; i < text.size(); i++) {
        bool escape = text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0;
        out.push_back(escape ? static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2])) : text[i]);
        i += escape ? 2 : 0;
    }
    return out;
}

bool has_scheme(const std::string &uri)
{
    size_t end = uri.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+.-");
    return end != std::string::npos && end > 0 && uri[end] == ':';
}

std::vector<std::string> split_path(const std::string &path)
{
    std::vector<std::string> parts;
    size_t start = 0;
    while (start <= path.size()) {
        size_t end = path.find('/', start);
        end = end == std::string::npos ? path.size() : end;
        std::string part = path.substr(start, end - start);
        if (!part.empty() && part != ".")
            parts.push_back(part);
        start = end + 1;
    }
    return parts;
}

/* Without openat2 (a kernel before 5.6, or a sandbox that refuses it): each step by itself, no symbolic link followed. */
int open_step_by_step(int folder_fd, const std::vector<std::string> &parts)
{
    int at = dup(folder_fd);
    for (size_t i = 0; i < parts.size() && at >= 0; i++) {
        int flags = O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | (i + 1 < parts.size() ? O_DIRECTORY : 0);
        int next = openat(at, parts[i].c_str(), flags);
        int saved = errno;
        close(at);
        errno = saved;
        at = next;
    }
    return at;
}

int open_beneath(int folder_fd, const std::vector<std::string> &parts)
{
    std::string path;
    for (const std::string &part : parts)
        path += (path.empty() ? "" : "/") + part;
    struct open_how how = {};
    how.flags = O_RDONLY | O_CLOEXEC | O_NONBLOCK;
    how.resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS;
    long fd = syscall(SYS_openat2, folder_fd, path.c_str(), &how, sizeof how);
    if (fd < 0 && (errno == ENOSYS || errno == EPERM))
        return open_step_by_step(folder_fd, parts);
    return static_cast<int>(fd);
}

int base64_digit(char c)
{
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* RFC 4648, 4; padding may be left out. */
bytes decode_base64(const char *text, size_t length, const char *what)
{
    while (length > 0 && text[length - 1] == '=')
        length--;
    if (length % 4 == 1)
        fail("%s: the base64 data are cut off", what);
    bytes out(length / 4 * 3 + (length % 4 ? length % 4 - 1 : 0));
    uint32_t bits = 0;
    size_t written = 0;
    for (size_t i = 0; i < length; i++) {
        int digit = base64_digit(text[i]);
        if (digit < 0)
            fail("%s: character %zu of the base64 data is none of A-Z a-z 0-9 + /", what, i);
        bits = bits << 6 | static_cast<uint32_t>(digit);
        if (i % 4 != 0)
            out.data[written++] = static_cast<uint8_t>(bits >> (6 - 2 * (i % 4)));
    }
    return out;
}

} // namespace

bytes read_scene_file(const char *path)
{
    descriptor file(open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (file.fd < 0) {
        bool missing = errno == ENOENT || errno == ENOTDIR;
        fail_with(missing ? ERROR_NO_INPUT : ERROR_IO, "%s: %s; a .gltf or .glb file or builtin:NAME is accepted", path,
                  missing ? "no such file" : strerror(errno));
    }
    return read_regular(file.fd, path, file_size_max);
}

folder::folder(const char *path)
{
    const char *slash = strrchr(path, '/');
    std::string name = slash ? std::string(path, static_cast<size_t>(slash - path) + 1) : ".";
    fd_ = open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd_ < 0)
        fail_with(ERROR_IO, "the folder %s cannot be opened: %s", name.c_str(), strerror(errno));
}

folder::~folder() { close(fd_); }

bytes folder::read(const std::string &uri, const char *what, uint64_t limit) const
{
    std::string shown = uri.substr(0, 120), path = percent_decode(uri);
    if (has_scheme(uri))
        fail("%s: the uri \"%s\" is not a relative one: files are read from the scene's folder only", what, shown.c_str());
    if (path.find('\0') != std::string::npos)
        fail("%s: the uri holds a zero byte", what);
    std::vector<std::string> parts = split_path(path);
    bool climbs = false;
    for (const std::string &part : parts)
        climbs |= part == "..";
    if ((!path.empty() && path[0] == '/') || climbs)
        fail("%s: \"%s\" lies outside the scene's folder", what, shown.c_str());
    if (parts.empty())
        fail("%s: \"%s\" is not a file", what, shown.c_str());
    descriptor file(open_beneath(fd_, parts));
    if (file.fd < 0 && (errno == EXDEV || errno == ELOOP))
        fail("%s: \"%s\" leads outside the scene's folder", what, shown.c_str());
    if (file.fd < 0)
        fail("%s: \"%s\" cannot be opened: %s", what, shown.c_str(), strerror(errno));
    return read_regular(file.fd, (std::string(what) + " \"" + shown + "\"").c_str(), limit);
}

bool is_data_uri(const std::string &uri) { return uri.compare(0, 5, "data:") == 0; }

bytes decode_data_uri(const std::string &uri, const char *what)
{
    size_t comma = uri.find(',');
    if (comma == std::string::npos)
        fail("%s: the data: uri has no comma before its data", what);
    bool base64 = comma >= 12 && uri.compare(comma - 7, 7, ";base64") == 0;
    if (base64)
        return decode_base64(uri.data() + comma + 1, uri.size() - comma - 1, what);
    std::string text = percent_decode(uri.substr(comma + 1));
    bytes out(text.size());
    memcpy(out.data.get(), text.data(), text.size());
    return out;
}

} // namespace gltf

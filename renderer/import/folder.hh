/* The scene's folder: the only place where files are opened. */
#pragma once

#include <string>

#include "import/bytes.hh"

namespace gltf
{

/* Files, and all buffers of a scene together, end here. */
constexpr uint64_t file_size_max = UINT64_C(1) << 31;

/* Reads a regular file; `what` names it in errors. Fails with ERROR_NO_INPUT if it does not exist. */
bytes read_scene_file(const char *path);

class folder
{
  public:
    /* The folder that holds `path`. */
    explicit folder(const char *path);
    ~folder();
    folder(const folder &) = delete;
    folder &operator=(const folder &) = delete;

    /* The file that the relative reference `uri` (percent-encoded) names. Fails (ERROR_DATA) when it is missing, not a regular file, larger
     * than `limit` or outside the folder, symbolic links followed. */
    bytes read(const std::string &uri, const char *what, uint64_t limit) const;

  private:
    int fd_;
};

bool is_data_uri(const std::string &uri);

/* The bytes of a data: URI (RFC 2397), base64 or percent-encoded. */
bytes decode_data_uri(const std::string &uri, const char *what);

} // namespace gltf

/* The JSON of a glTF file: parsed under limits, every member that is read checked for type, range and reference by one table of rules,
 * then handed to tinygltf without buffers and images, so that tinygltf never sees a URI. */
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "import/bytes.hh"

namespace tinygltf
{
class Model;
}

namespace gltf
{

class warnings;

/* buffers[i] or images[i] as the file says. */
struct resource {
    std::string uri; /* "" if it has none */
    std::string mime;
    uint64_t byte_length = 0; /* buffers */
    int buffer_view = -1;     /* images */
    bool has_uri = false;
};

struct document {
    std::unique_ptr<tinygltf::Model> model;
    std::vector<resource> buffers, images;
    std::vector<std::string> animations; /* names only */
    size_t skin_count = 0;

    document();
    ~document();
};

void read_document(span json, document &out, warnings &warn);

} // namespace gltf

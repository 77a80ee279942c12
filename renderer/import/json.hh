/* JSON text to nlohmann's values, with limits. */
#pragma once

#include <nlohmann/json.hpp>

#include "import/bytes.hh"

namespace gltf
{

using json = nlohmann::json;

/* Fails on bad syntax, bad UTF-8, duplicate keys, more than 256 levels, more than 256 MiB. */
json parse_json(span text);

} // namespace gltf

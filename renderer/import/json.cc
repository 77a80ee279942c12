#include "import/json.hh"

#include <set>
#include <vector>

#include "import/failure.hh"

namespace gltf {
namespace {

/* glTF itself nests about 8 deep; extras may go further. tinygltf walks extras and extensions recursively. */
constexpr int depth_max = 256;
constexpr size_t text_max = size_t{1} << 28;

/* Sees each key and bracket while nlohmann's parser, which does not recurse, reads on. */
class key_guard {
public:
    bool operator()(int depth, json::parse_event_t event, json &value)
    {
        if (depth > depth_max)
            fail("the JSON is nested more than %d deep", depth_max);
        if (event == json::parse_event_t::object_start)
            keys_.emplace_back();
        else if (event == json::parse_event_t::object_end)
            keys_.pop_back();
        else if (event == json::parse_event_t::key && !keys_.back().insert(value.get<std::string>()).second)
            fail("the JSON has the key \"%.100s\" twice in one object", value.get_ref<const std::string &>().c_str());
        return true;
    }

private:
    std::vector<std::set<std::string>> keys_;
};

} // namespace

json parse_json(span text)
{
    if (text.size > text_max)
        fail("the JSON has %zu bytes, at most %zu are accepted", text.size, text_max);
    if (text.size == 0)
        fail("the file is empty; glTF JSON or a GLB is accepted");
    key_guard guard;
    try {
        return json::parse(text.data, text.data + text.size,
                           [&guard](int depth, json::parse_event_t event, json &value) { return guard(depth, event, value); });
    } catch (const json::exception &e) {
        fail("the JSON is not valid: %.300s", e.what());
    }
}

} // namespace gltf

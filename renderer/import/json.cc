#include "import/json.hh"

#include <set>
#include <vector>

#include "import/failure.hh"

namespace gltf
{
namespace
{

/* glTF itself nests about 8 deep; extras may go further. tinygltf walks extras and extensions recursively. */
constexpr int depth_max = 256;
constexpr size_t text_max = size_t{1} << 28;

/* A pass over the text that keeps nothing but the keys of the open objects. nlohmann's parser does not recurse; its callback parser, which
 * could do the same while it builds values, takes time quadratic in the length of an array. */
class guard : public nlohmann::json_sax<json>
{
  public:
    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(number_integer_t) override { return true; }
    bool number_unsigned(number_unsigned_t) override { return true; }
    bool number_float(number_float_t, const string_t &) override { return true; }
    bool string(string_t &) override { return true; }
    bool binary(binary_t &) override { return true; }
    bool start_array(std::size_t) override { return deeper(); }
    bool end_array() override { return depth_-- > 0; }
    bool start_object(std::size_t) override
    {
        keys_.emplace_back();
        return deeper();
    }
    bool end_object() override
    {
        keys_.pop_back();
        return depth_-- > 0;
    }
    bool key(string_t &name) override
    {
        if (!keys_.back().insert(name).second)
            fail("the JSON has the key \"%.100s\" twice in one object", name.c_str());
        return true;
    }
    bool parse_error(std::size_t, const std::string &, const nlohmann::detail::exception &e) override
    {
        fail("the JSON is not valid: %.300s", e.what());
    }

  private:
    bool deeper()
    {
        if (++depth_ > depth_max)
            fail("the JSON is nested more than %d deep", depth_max);
        return true;
    }

    int depth_ = 0;
    std::vector<std::set<std::string>> keys_;
};

} // namespace

json parse_json(span text)
{
    if (text.size > text_max)
        fail("the JSON has %zu bytes, at most %zu are accepted", text.size, text_max);
    if (text.size == 0)
        fail("the file is empty; glTF JSON or a GLB is accepted");
    guard check;
    json::sax_parse(text.data, text.data + text.size, &check);
    return json::parse(text.data, text.data + text.size);
}

} // namespace gltf

/* What was read past, one sentence each; a repeated one counts once. */
#pragma once

#include <set>
#include <string>
#include <vector>

struct import_report;

namespace gltf
{

class warnings
{
  public:
    void add(const char *format, ...) __attribute__((format(printf, 2, 3)));
    /* To `report`, or to the log when it is NULL. */
    void hand_over(struct import_report *report, const char *name) const;

  private:
    std::set<std::string> seen_;
    std::vector<std::string> list_;
};

} // namespace gltf

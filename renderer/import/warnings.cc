#include "import/warnings.hh"

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "import/bridge.hh"

namespace gltf
{

constexpr size_t warnings_max = 64;

void warnings::add(const char *format, ...)
{
    char text[256];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    for (char *c = text; *c; c++)
        if (static_cast<unsigned char>(*c) < 0x20 || *c == 0x7f)
            *c = '?';
    if (list_.size() < warnings_max && seen_.insert(text).second)
        list_.push_back(text);
}

void warnings::hand_over(struct import_report *report, const char *name) const
{
    if (!report) {
        for (const std::string &text : list_)
            log_warning("%s: %s", name, text.c_str());
        return;
    }
    report->warnings = static_cast<char(*)[256]>(calloc(list_.size() + 1, sizeof *report->warnings));
    if (!report->warnings)
        throw std::bad_alloc();
    for (const std::string &text : list_)
        snprintf(report->warnings[report->warning_count++], sizeof *report->warnings, "%s", text.c_str());
}

} // namespace gltf

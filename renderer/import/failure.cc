#include "import/failure.hh"

#include <cstdarg>
#include <cstdio>
#include <new>

namespace gltf
{

failure::failure(enum error_code code, const char *text) : code_(code) { snprintf(text_, sizeof text_, "%s", text); }

void fail(const char *format, ...)
{
    char text[480];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    throw failure(ERROR_DATA, text);
}

void fail_with(enum error_code code, const char *format, ...)
{
    char text[480];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    throw failure(code, text);
}

bool guarded(struct error *err, void (*work)(void *context), void *context)
{
    try {
        work(context);
        return true;
    } catch (const failure &f) {
        return error_set(err, f.code(), NULL, "%s", f.what());
    } catch (const std::bad_alloc &) {
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory while reading the file");
    } catch (const std::exception &e) {
        return error_set(err, ERROR_DATA, NULL, "the file cannot be read: %s", e.what());
    }
}

} // namespace gltf

/* How the importer's C++ gives up: an exception that carries one sentence, turned into a struct error at the C border. */
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>

extern "C" {
#include "base/error.h"
}

namespace gltf
{

class failure : public std::exception
{
  public:
    failure(enum error_code code, const char *text);
    const char *what() const noexcept override { return text_; }
    enum error_code code() const noexcept { return code_; }

  private:
    enum error_code code_;
    char text_[480];
};

/* Throws failure: ERROR_DATA, or `code`. */
[[noreturn]] void fail(const char *format, ...) __attribute__((format(printf, 1, 2)));
[[noreturn]] void fail_with(enum error_code code, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Runs `work`, turning what it throws into `err`. False when it threw. */
bool guarded(struct error *err, void (*work)(void *context), void *context);

} // namespace gltf

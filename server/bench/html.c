#include "html.h"

#include <math.h>
#include <string.h>

#include "shadow/shadow.h"

enum { COLORS = 14 };

void html_put_text(FILE *out, const char *text)
{
    for (; *text; text++)
        switch (*text) {
        case '&': fputs("&amp;", out); break;
        case '<': fputs("&lt;", out); break;
        case '>': fputs("&gt;", out); break;
        case '"': fputs("&quot;", out); break;
        default: fputc(*text, out);
        }
}

/* RFC 4648. */
void html_put_data(FILE *out, const char *media, const uint8_t *data, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    fprintf(out, "data:%s;base64,", media);
    for (size_t i = 0; i < size; i += 3) {
        uint32_t b = (uint32_t)data[i] << 16 | (i + 1 < size ? (uint32_t)data[i + 1] << 8 : 0) | (i + 2 < size ? data[i + 2] : 0);
        fputc(digits[b >> 18], out);
        fputc(digits[b >> 12 & 63], out);
        fputc(i + 1 < size ? digits[b >> 6 & 63] : '=', out);
        fputc(i + 2 < size ? digits[b & 63] : '=', out);
    }
}

void html_put_number(FILE *out, double value)
{
    if (!isfinite(value))
        fputs("–", out);
    else if (value == 0)
        fputs("0", out);
    else if (fabs(value) >= 100)
        fprintf(out, "%.0f", value);
    else if (fabs(value) >= 0.001)
        fprintf(out, "%.3g", value);
    else
        fprintf(out, "%.1e", value);
}

unsigned html_color(const struct shadow_system *system)
{
    for (unsigned i = 0; i < shadow_system_count; i++)
        if (shadow_systems[i] == system)
            return i % COLORS;
    return 0;
}

void html_short_name(const char *algorithm, char *out, size_t size)
{
    static const char *const implied[] = {"size=", "samples=", "tracer="};
    size_t used = 0;
    for (const char *at = algorithm; *at && used + 1 < size; at++) {
        out[used++] = *at == ':' || *at == ',' ? ' ' : *at;
        for (size_t i = 0; (*at == ':' || *at == ',') && i < sizeof implied / sizeof implied[0]; i++)
            if (!strncmp(at + 1, implied[i], strlen(implied[i]))) {
                at += strlen(implied[i]);
                break;
            }
    }
    out[used] = 0;
}

#include "base/embed.h"
#include "html.h"
#include "html_sections.h"
#include "write.h"

static void put_head(const struct bench_report *report, FILE *out)
{
    fprintf(out,
            "<!doctype html>\n<html lang=en>\n<head>\n<meta charset=utf-8>\n<meta name=viewport content=\"width=device-width\">\n"
            "<title>Gnomon bench: %s</title>\n<style>\n",
            report->plan.suite->name);
    fputs(embedded_report[0].data, out);
    fputs("</style>\n</head>\n<body>\n", out);
}

static size_t count_done(const struct bench_plan *plan)
{
    size_t n = 0;
    for (size_t i = 0; i < plan->cells.count; i++)
        n += plan->cells.data[i].started;
    return n;
}

static void put_title(const struct bench_report *report, FILE *out)
{
    char started[60];
    struct tm utc;
    strftime(started, sizeof started, "%e %B %Y, %H:%M UTC", gmtime_r(&report->started, &utc));
    fprintf(out,
            "<header><h1>Shadows: what they cost and how wrong they are</h1>\n<p class=soft>Suite <b>%s</b> of gnomon %s, %s. ",
            report->plan.suite->name, GNOMON_VERSION, started);
    html_put_text(out, report->device.renderer);
    fputs(", ", out);
    html_put_text(out, report->device.version);
    if (report->processor[0]) {
        fputs("; ", out);
        html_put_text(out, report->processor);
    }
    fprintf(out, ", %u thread%s. %zu of %zu cells in %.0f s, pictures of %u × %u%s.</p>\n<p><code>", report->threads,
            report->threads == 1 ? "" : "s", count_done(&report->plan), report->plan.cells.count, report->seconds,
            report->plan.width, report->plan.height, report->interrupted ? ", <b>ended early</b>" : "");
    html_put_text(out, report->command);
    fputs("</code></p></header>\n", out);
}

static void put_navigation(const struct bench_report *report, FILE *out)
{
    fputs(
        "<nav><a href=\"#short\">In short</a><a href=\"#front\">Time against error</a><a href=\"#passes\">Where the time goes</a>",
        out);
    if (report->pictures.count)
        fputs("<a href=\"#figures\">Pictures</a>", out);
    for (unsigned t = 0; report->plan.suite->tables[t]; t++) {
        if (!html_table_has_rows(&report->plan, t))
            continue;
        fprintf(out, "<a href=\"#%s\">", report->plan.suite->tables[t]->name);
        html_put_text(out, report->plan.suite->tables[t]->title);
        fputs("</a>", out);
    }
    fputs("<a href=\"#how\">How it was measured</a></nav>\n", out);
}

static void put_method(const struct bench_report *report, FILE *out)
{
    fputs(
        "<section id=how><h2>How it was measured</h2>\n<p>Algorithms of one scene and map size take turns frame by frame (A B C A B C), after untimed "
        "frames; a frame is from its start to its pixels in CPU memory, one in flight. Numbers are medians, with the quartiles beside them; what one takes "
        "<em>over</em> another is the median of the ratios of frames taken in the same round, so that a machine that slows down slows both. Slow ones get fewer "
        "frames. Light moving: each round turns the light by 0.25 degrees.</p>\n<p><em>wrong</em>: pixels whose visibility is off by more than one half "
        "from exact ray tracing of the pixel's centre; <em>leaks</em> and <em>acne</em>: those of them well inside shadow, and well inside light; "
        "<em>of best</em>: over the fewest that the baseline has at the same map size, whatever its bias; <em>edge 95 %</em>: 95 % of the shadow's edge lies within "
        "that many 1/32 pixels of the true one; <em>RMSE 32</em> and <em>wrong samples</em>: against 32 exact samples a pixel; <em>RMSE area</em>: against a disc of "
        "256 rays; <em>lists hold</em>: of the triangles that the light sees in a texel, the share that the texel's list holds (mean over texels with two or "
        "more). Published figures are quoted from the papers as they stand.</p>\n<ul>\n",
        out);
    for (size_t i = 0; i < report->plan.left_out.count; i++) {
        fputs("<li class=soft>", out);
        html_put_text(out, report->plan.left_out.data[i]);
        fputs("</li>\n", out);
    }
    fputs("</ul></section>\n", out);
}

void bench_html(const struct bench_report *report, FILE *out)
{
    put_head(report, out);
    put_title(report, out);
    put_navigation(report, out);
    html_put_summary(report, out);
    html_put_fronts(report, out);
    html_put_shares(report, out);
    html_put_figures(report, out);
    html_put_scaling(report, out);
    html_put_tables(report, out);
    put_method(report, out);
    fputs("</body>\n</html>\n", out);
}

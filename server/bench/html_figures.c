#include <string.h>

#include "html.h"
#include "html_sections.h"

static void put_picture(const struct bench_picture *p, FILE *out)
{
    /* Overviews alone are not for counting pixels. */
    fprintf(out, "<figure%s><img width=%u height=%u alt=\"", strcmp(p->media, "image/png") ? " class=whole" : "", p->width,
            p->height);
    html_put_text(out, p->caption);
    fputs("\" src=\"", out);
    html_put_data(out, p->media, p->data, p->size);
    fputs("\"><figcaption>", out);
    html_put_text(out, p->caption);
    fputs("</figcaption></figure>\n", out);
}

void html_put_figures(const struct bench_report *report, FILE *out)
{
    size_t last = SIZE_MAX;
    for (size_t i = 0; i < report->pictures.count; i++) {
        const struct bench_picture *p = &report->pictures.data[i];
        const struct bench_figure *figure = report->plan.suite->figures[p->figure];
        if (p->figure != last) {
            fputs(
                last == SIZE_MAX
                    ? "<section id=figures><h2>Pictures</h2><p class=note>Cut out where the first is most wrong, and enlarged.</p>\n"
                    : "</div>\n",
                out);
            fputs("<h3>", out);
            html_put_text(out, figure->title);
            fputs("</h3><p class=note>", out);
            html_put_text(out, figure->note);
            fprintf(out, "</p><div class=\"gallery%s\">\n", figure->kind == FIGURE_PAIRS ? " pairs" : "");
        }
        last = p->figure;
        put_picture(p, out);
    }
    if (last != SIZE_MAX)
        fputs("</div></section>\n", out);
}

/* Which instances a view can see. */
#pragma once

#include <stdbool.h>

#include "scene/view.h"

/* False only if no point of `box` lies in the view's picture between `near` (ignored if ignore_near) and far. */
bool cull_box_visible(const struct view *view, const struct dbox *box, bool ignore_near);

#include <libwebsockets.h>
#include "renderer.h"
#include "session.h"
#include "proto/tables.h"
#include "gl/texture.h"
#include "frame_header.h"
#include "proto/frame_header.h"

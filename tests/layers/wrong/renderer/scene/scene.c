#include "scene/scene.h"
#include <EGL/egl.h>
#include <pthread.h>
#include <sys/socket.h>
#include "gl/texture.h"
#include "missing.h"

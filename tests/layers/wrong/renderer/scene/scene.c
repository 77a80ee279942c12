#include "scene/scene.h"
#include <EGL/egl.h>
#include <pthread.h>
#include <sys/socket.h>
#include "gl/texture.h"
#include "missing.h"

static pthread_mutex_t lock; /* a lock is no thread */
void start(void) { pthread_create(0, 0, 0, 0); }
#include <epoxy/gl.h>

/* Linked into every program of a sanitizer build. A GL driver is unloaded with its display; what it still holds then has no module and no
 * names any more, so that lsan.supp and tsan.supp could not tell it from ours. Here libraries stay. */
int dlclose(void *handle);

int dlclose(void *handle)
{
    (void)handle;
    return 0;
}

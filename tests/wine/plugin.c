/* A plug-in for Windows: its file is the tree's GLB, as it was given. */
#include <windows.h>

int main(int count, char **arguments) {
    return count == 3 && CopyFileA(arguments[1], arguments[2], FALSE) ? 0 : 1;
}

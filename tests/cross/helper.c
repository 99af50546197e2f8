// Runs a Windows program under conditions that a shell cannot make; returns its exit code.
//   helper hold FILE PROGRAM ARGUMENTS...      while FILE is open and may only be read
//   helper ctrl-c MS PROGRAM ARGUMENTS...      presses Ctrl-C in its console after so many milliseconds
//   helper console MS PROGRAM ARGUMENTS...     in a console window of its own, for so many milliseconds
#include <stdio.h>
#include <windows.h>

static BOOL WINAPI ignore(DWORD event) {
    return event == CTRL_C_EVENT;
}

int wmain(int count, wchar_t **arguments) {
    if (count < 4) return 99;
    const wchar_t *what = arguments[1];
    int holds = !wcscmp(what, L"hold");
    if (holds) {
        HANDLE file =
            CreateFileW(arguments[2], GENERIC_READ, FILE_SHARE_READ, NULL, OPEN_EXISTING, 0, NULL);
        if (file == INVALID_HANDLE_VALUE) return 98;
    } else {
        FreeConsole();
        if (!AllocConsole()) return 97;
    }
    wchar_t line[8192] = L"";
    for (int i = 3; i < count; i++) {
        wcscat(line, L"\"");
        wcscat(line, arguments[i]);
        wcscat(line, L"\" ");
    }
    STARTUPINFOW start = {.cb = sizeof start};
    PROCESS_INFORMATION process;
    if (!CreateProcessW(NULL, line, NULL, NULL, TRUE, 0, NULL, NULL, &start, &process)) return 96;
    DWORD wait = holds ? 60000 : _wtoi(arguments[2]);
    if (!wcscmp(what, L"ctrl-c")) {
        SetConsoleCtrlHandler(ignore, TRUE);
        Sleep(wait);
        if (!GenerateConsoleCtrlEvent(CTRL_C_EVENT, 0)) return 95;
        wait = 20000;
    }
    WaitForSingleObject(process.hProcess, wait);
    DWORD code = 94;
    GetExitCodeProcess(process.hProcess, &code);
    return code;
}

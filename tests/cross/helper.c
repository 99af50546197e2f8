// Runs a Windows program under conditions that a shell cannot make; returns its exit code.
//   helper hold FILE PROGRAM ARGUMENTS...           while FILE is open and may only be read
//   helper event NUMBER MS PROGRAM ARGUMENTS...     in a console of its own, which sends it an event after so many
//                                                   milliseconds and waits as long for its end as Windows does
#include <stdio.h>
#include <windows.h>

static BOOL WINAPI ignore(DWORD event) {
    return event == CTRL_C_EVENT;
}

// Wine delivers Ctrl-C only. So the other events come the way in which Windows delivers them: as a thread in the program
// that runs CtrlRoutine, which lies at the same address in all programs.
static BOOL deliver(HANDLE process, DWORD event) {
    if (event == CTRL_C_EVENT) return GenerateConsoleCtrlEvent(event, 0);
    FARPROC routine = GetProcAddress(GetModuleHandleW(L"kernelbase"), "CtrlRoutine");
    return routine && CreateRemoteThread(process, NULL, 0, (LPTHREAD_START_ROUTINE)routine, (void *)(UINT_PTR)event, 0, NULL);
}

int wmain(int count, wchar_t **arguments) {
    if (count < 5) return 99;
    int holds = !wcscmp(arguments[1], L"hold");
    if (holds) {
        HANDLE file =
            CreateFileW(arguments[2], GENERIC_READ, FILE_SHARE_READ, NULL, OPEN_EXISTING, 0, NULL);
        if (file == INVALID_HANDLE_VALUE) return 98;
    } else {
        FreeConsole();
        if (!AllocConsole()) return 97;
    }
    wchar_t line[8192] = L"";
    for (int i = holds ? 3 : 4; i < count; i++) {
        wcscat(line, L"\"");
        wcscat(line, arguments[i]);
        wcscat(line, L"\" ");
    }
    STARTUPINFOW start = {.cb = sizeof start};
    PROCESS_INFORMATION process;
    if (!CreateProcessW(NULL, line, NULL, NULL, TRUE, 0, NULL, NULL, &start, &process)) return 96;
    if (!holds) {
        SetConsoleCtrlHandler(ignore, TRUE);
        Sleep(_wtoi(arguments[3]));
        if (!deliver(process.hProcess, _wtoi(arguments[2]))) return 95;
    }
    if (WaitForSingleObject(process.hProcess, holds ? 60000 : 5000)) TerminateProcess(process.hProcess, 94);
    DWORD code = 93;
    GetExitCodeProcess(process.hProcess, &code);
    return code;
}

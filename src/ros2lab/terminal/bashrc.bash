# What a terminal of the lab reads at its start: the home folder's .bashrc, as every bash does, and then what
# tells the notebook where a command ends. The signs are those of https://gitlab.freedesktop.org/Per_Bothner/specifications
# (OSC 133), which no program prints by accident.
[ -r ~/.bashrc ] && . ~/.bashrc

__lab_prompt() {
    local code=$?
    PS0='\e]133;C\a' PS1='' PS2='\e]133;P\a'
    printf '\e]133;D;%s;%s\a' "$code" "${PWD/#"$HOME"/'~'}"
    return $code
}
PROMPT_COMMAND=__lab_prompt
HISTFILE=
# An exclamation mark in a message is no command of the history.
set +H

# What a terminal of the lab reads at its start: the home folder's .bashrc, as every bash does, and then what
# tells the notebook where a command ends. The signs are those of https://gitlab.freedesktop.org/Per_Bothner/specifications
# (OSC 133), with a word at their end that what is printed cannot know.
__lab_word=$ROS2LAB_WORD
unset ROS2LAB_WORD
[ -r ~/.bashrc ] && . ~/.bashrc

__lab_prompt() {
    local code=$?
    PS0="\e]133;C;$__lab_word\a" PS1='' PS2="\e]133;P;$__lab_word\a"
    printf '\e]133;D;%s;%s;%s\a' "$code" "${PWD/#"$HOME"/'~'}" "$__lab_word"
    return $code
}
PROMPT_COMMAND=__lab_prompt
HISTFILE=
# An exclamation mark in a message is no command of the history.
set +H

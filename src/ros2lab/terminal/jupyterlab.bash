# What a terminal of JupyterLab reads at its start: the prompt of the notebooks' terminals, completion, and the home
# folder's .bashrc, as every bash does.
PS1='\[\e[1;32m\]lab\[\e[0m\]:\[\e[1;34m\]\w\[\e[0m\]$ '

# The first TAB asks argcomplete for what it needs, so that a new terminal does not wait for it.
__lab_complete() {
    complete -r "$1"
    eval "$(register-python-argcomplete "$1" 2>/dev/null)"
    return 124 # bash tries again, with what this has set
}
complete -o default -F __lab_complete ros2 colcon

# JupyterLab starts it in the folder that its file browser shows.
cd || return
[ -r ~/.bashrc ] && . ~/.bashrc
